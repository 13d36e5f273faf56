"""Every robot of `examples/` comes up, stands free, and moves within its limits."""

from pathlib import Path

import pytest

from station.app.composition import Composition, compose
from station.config import load_config
from station.core.control.switching import SwitchRequest
from station.core.franka.arms import Arms
from station.core.hardware.limits import ClampReason

EXAMPLES = Path(__file__).parents[2] / "examples"
# Half a degree is 0.0087 rad.
FAR = (
    "position_group_controller",
    "velocity_group_controller",
    "effort_group_effort_controller",
)
FRANKAS = ("franka_examples", "dual_panda", "four_pandas")
ROBOTS = sorted({path.stem for path in EXAMPLES.glob("*.yaml")} - {"cube", *FRANKAS})


def run(robot: str) -> Composition:
    composition = compose(load_config(EXAMPLES / f"{robot}.yaml"))
    assert not composition.not_loaded
    composition.station.loop.step(100)
    return composition


@pytest.mark.parametrize("robot", ROBOTS)
def test_robot_moves_with_its_position_group_controller(robot):
    station = run(robot).station
    name = "position_group_controller"
    station.switch_controllers(SwitchRequest(start=[name]))
    joints = [element.name for element in station.motion.set_point(name).elements]
    before = station.latest().position[: len(joints)]
    target = [position + 0.15 for position in before]

    station.motion.set_command(name, target)
    station.loop.step(1200)

    assert station.joint_names[: len(joints)] == joints
    assert station.latest().position[: len(joints)] == pytest.approx(target, abs=1e-3)


@pytest.mark.long
@pytest.mark.parametrize("robot", ROBOTS)
def test_robot_touches_nothing_where_it_starts(robot):
    assert run(robot).station.loop.hw.world.data.ncon == 0


@pytest.mark.parametrize("robot", ["ur5", "differential_wrist", "four_bar_leg"])
def test_effort_controller_takes_over_without_a_jump(robot):
    station = run(robot).station
    before = station.latest().position
    name = "effort_group_position_controller"
    station.switch_controllers(SwitchRequest(start=[name]))
    station.loop.step(500)

    assert station.latest().position == pytest.approx(before, abs=2e-3)
    assert station.controller(name).fault is None


@pytest.mark.parametrize("robot", ROBOTS)
def test_far_commands_leave_no_joint_out_of_its_bounds(robot):
    station = run(robot).station
    hw = station.loop.hw
    limits = {report.joint: report for report in station.hardware().limits}
    assert all(limits[j].soft_limits for j in limits if j != "gripper_left_joint")
    names = [name for name in FAR if name in {c.name for c in station.controllers()}]
    running = []
    for name in names:
        station.switch_controllers(SwitchRequest(start=[name], stop=running))
        running = [name]
        elements = station.motion.set_point(name).elements
        for far in ([e.maximum for e in elements], [e.minimum for e in elements]):
            # Beyond these the station refuses a command.
            station.motion.set_command(
                name, [max(-100.0, min(100.0, end)) for end in far]
            )
            for _ in range(500):
                station.loop.step(1)
                check_bounds(station, limits)
    assert len(station.status().clamps) >= len(names)
    assert hw.mode() == "running"


def check_bounds(station, limits):
    latest = station.latest()
    for name, position, velocity in zip(
        station.joint_names, latest.position, latest.velocity, strict=True
    ):
        if name not in limits:  # a joint without a motor
            continue
        limit = limits[name].limits
        assert abs(velocity) < 1.02 * limit.max_velocity, name
        if limit.min_position is not None:
            assert limit.min_position - 0.0087 < position < limit.max_position + 0.0087


def test_command_that_is_cut_off_shows_in_hardware_and_status():
    station = run("ur5").station
    name = "position_group_controller"
    station.switch_controllers(SwitchRequest(start=[name]))
    assert station.status().clamps == ()

    station.motion.set_command(name, [3.0, -1.2, 1.4, -1.8, -1.57, 0.0])
    station.loop.step(10)

    (clamp,) = station.status().clamps
    assert (clamp.last.joint, clamp.last.asked) == ("shoulder_pan_joint", 3.0)
    assert clamp.last.reason is ClampReason.VELOCITY
    assert station.hardware().clamps == (clamp,)


@pytest.mark.parametrize("robot", FRANKAS)
def test_every_controller_of_the_franka_examples_runs(robot):
    station = run(robot).station
    names = [one.name for one in station.controllers() if one.claimed_resources]
    assert names
    for name in names:
        station.switch_controllers(SwitchRequest(start=[name]))
        station.loop.step(200)
        assert station.controller(name).fault is None
        station.switch_controllers(SwitchRequest(stop=[name]))
        station.loop.step(200)
    for arm_id in Arms(station.robots).names():
        assert not any(Arms(station.robots).state(arm_id).last_motion_errors)
