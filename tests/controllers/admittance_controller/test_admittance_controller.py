"""What the controller refuses, and how its parameters reach the rule."""

from math import nan

import pytest

from station.core.errors import ControllerLoadError, ParameterError, SwitchRefusedError
from tests.conformance.benches import CONTROLLER_PARAMETERS, robot_bench

KIND = "admittance_controller/AdmittanceController"
NAMES = (
    "joints",
    "command_interfaces",
    "kinematics",
    "ft_sensor",
    "control",
    "fixed_world_frame",
    "gravity_compensation",
    "admittance",
)


def load(**more):
    bench = robot_bench()
    own = {name: CONTROLLER_PARAMETERS[name] for name in NAMES}
    return bench, bench.load_controller("it", KIND, **{**own, **more})


def test_it_rests_without_a_force_and_gives_way_to_one():
    bench, controller = load()
    bench.switch(start=["it"])
    bench.step(5)
    assert bench.fault("it") is None
    start = controller.sample.actual
    assert controller.sample.output == pytest.approx(start)

    controller.tunables.apply({**controller.tunables.values, "tool_weight": 10.0})
    bench.step(50)
    # A tool that is lighter than was said lifts the arm.
    assert controller.published()["state"]["wrench_base"][2] > 5.0
    assert controller.sample.output != pytest.approx(start, abs=1e-6)


def test_it_can_command_the_references_of_another_controller():
    bench = robot_bench()
    own = {name: CONTROLLER_PARAMETERS[name] for name in NAMES}
    joints = own["joints"]
    pid = bench.load_controller(
        "pid",
        "pid_controller/PidController",
        dof_names=joints,
        command_interface="effort",
        reference_and_state_interfaces=["position"],
        gains={joint: {"p": 1.0} for joint in joints},
    )
    commanded = [f"pid/{joint}" for joint in joints]
    it = bench.load_controller("it", KIND, **own, command_joints=commanded)
    bench.switch(start=["pid", "it"])
    bench.step(2)

    assert pid.is_in_chained_mode
    assert pid.sample.desired == it.sample.output


@pytest.mark.parametrize("sensor", ["wrench", "position"])
def test_it_goes_on_while_a_sensor_reads_nan(sensor):
    bench, controller = load()
    bench.switch(start=["it"])
    bench.step(5)
    before = controller.sample.output
    if sensor == "position":
        bench.robot.script.nan_sensors = set(controller.joint_names[:1])
    else:
        controller._sensor._force[0] = nan
    bench.step(5)

    assert bench.fault("it") is None
    assert controller.sample.output == pytest.approx(before, abs=1e-9)


def test_an_axis_that_is_not_selected_takes_no_force():
    bench, controller = load()
    values = {name: 0.0 for name in controller.tunables.values if "selected" in name}
    controller.tunables.apply({
        **controller.tunables.values,
        **values,
        "tool_weight": 10.0,
    })
    bench.switch(start=["it"])
    bench.step(50)

    assert controller.sample.output == pytest.approx(controller.sample.actual)


@pytest.mark.parametrize(
    ("more", "error", "words"),
    [
        ({"command_interfaces": ["effort"]}, ParameterError, r"\[position\]"),
        ({"command_joints": ["panda_joint1"]}, ParameterError, "one name for each"),
        (
            {"kinematics": {"base": "panda_link0", "tip": "moon"}},
            ControllerLoadError,
            "'moon'",
        ),
        (
            {"kinematics": {"base": "panda_link3", "tip": "panda_link1"}},
            ControllerLoadError,
            "not below",
        ),
        (
            {"fixed_world_frame": {"frame": {"id": "panda_link4"}}},
            ParameterError,
            "fixed to the base",
        ),
        ({"joints": ["panda_joint1"]}, ControllerLoadError, "none of the controller's"),
        (
            {"admittance": {"selected_axes": [1, 1, 1, 1, 1, 1]}},
            ParameterError,
            "mass' is missing|6 booleans",
        ),
    ],
)
def test_what_does_not_fit_is_refused(more, error, words):
    with pytest.raises(error, match=words):
        load(**more)


def test_trajectories_of_positions_and_velocities_are_its_references():
    bench, controller = load()
    joints = [f"it/{name}" for name in controller.joint_names]
    jtc = bench.load_controller(
        "jtc", "pos_vel_controllers/JointTrajectoryController", joints=joints
    )
    (status,) = (s for s in bench.manager.list_controllers() if s.name == "jtc")
    assert not status.claimed_resources[0].resources  # none of the robot's
    (info,) = (i.info for i in bench.manager.lifecycle.loaded if i.info.name == "jtc")
    assert len(info.references) == 2 * len(joints)
    with pytest.raises(SwitchRefusedError, match="'it'"):
        bench.switch(["jtc"])
    bench.switch(["it", "jtc"])
    bench.step(5)
    start = controller.sample.actual
    point = {
        "positions": [start[0] + 0.2, *start[1:]],
        "velocities": [0.0] * 7,
        "time_from_start": 0.5,
    }
    jtc.trajectories.follow_trajectory({"joint_names": joints, "points": [point]})
    halfway = []
    for _ in range(800):
        bench.step()
        halfway.append(controller.references[1][0])
    assert bench.fault("jtc") is None
    assert bench.fault("it") is None
    assert controller.is_in_chained_mode
    # A cubic is fastest in its middle, by 1.5 times the mean of 0.4 rad/s.
    assert max(halfway) == pytest.approx(0.6, rel=0.05)
    assert controller.sample.output[0] == pytest.approx(start[0] + 0.2, abs=2e-3)
