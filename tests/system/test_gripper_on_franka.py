"""The gripper action on the hand of the simulated arm."""

import pytest

from station.app.composition import compose
from station.config import load_config
from station.core.clock import ManualClock
from station.core.control.switching import SwitchRequest
from station.core.facade.station import Station
from station.core.ports.goal import GoalStatus

FINGER = "panda_finger_joint1"
# A real hand's friction is not simulated; the gains are those of franka_gazebo.
PARAMETERS = {
    "joint": FINGER,
    "goal_tolerance": 0.001,
    "stall_timeout": 0.2,
    "stall_velocity_threshold": 0.003,
    "max_effort": 10.0,
    "gains": {FINGER: {"p": 1000.0, "d": 20.0, "i": 0.0}},
}
KINDS = ["effort", "position"]


@pytest.fixture(params=KINDS)
def station(request) -> Station:
    station = compose(load_config(), ManualClock()).station
    kind = f"{request.param}_controllers/GripperActionController"
    station.load_controller("gripper", kind, PARAMETERS)
    arm = "effort_joint_trajectory_controller"
    station.switch_controllers(SwitchRequest(start=("gripper", arm)))
    station.loop.step(5)
    return station


def finger(station: Station) -> float:
    return station.controller_sample("gripper").actual[0]


def test_it_closes_opens_and_leaves_the_arm_where_it_is(station):
    before = list(station.latest().position)
    for position in (0.01, 0.035):
        goal = station.motion.submit_goal(
            "gripper", {"command": {"position": position}}
        )
        station.loop.step(800)
        assert goal.status is GoalStatus.SUCCEEDED
        assert finger(station) == pytest.approx(position, abs=1.1e-3)
    assert list(station.latest().position) == pytest.approx(before, abs=1e-3)


def test_something_between_the_fingers_is_told_within_half_a_second(station):
    station.loop.hw.simulated_world().world.data.qfrc_applied[7] = 300.0
    goal = station.motion.submit_goal(
        "gripper", {"command": {"position": 0.005, "max_effort": 5.0}}
    )

    station.loop.step(500)

    assert goal.status is GoalStatus.ABORTED
    assert goal.result.details["stalled"] is True
    assert goal.result.details["position"] > 0.01


def test_a_stop_holds_the_fingers_and_ends_the_goal(station):
    goal = station.motion.submit_goal("gripper", {"command": {"position": 0.005}})
    station.loop.step(20)
    station.stop("test")
    station.loop.step(300)

    assert goal.status is GoalStatus.PREEMPTED
    gripper = station.loop.hw.simulated_world().grippers["panda"]
    held = gripper.read_position()
    station.loop.step(300)
    assert gripper.read_position() == pytest.approx(held, abs=1e-4)
    assert gripper.read_position() > 0.006
