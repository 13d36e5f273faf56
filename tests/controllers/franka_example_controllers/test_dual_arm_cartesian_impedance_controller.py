"""Two arms move as if they held one thing."""

from math import cos, sin

import numpy as np
import pytest

from station.core.control.switching import SwitchRequest
from station.core.errors import ControllerLoadError
from station.core.franka import Frame
from station.core.franka.arms import Arms
from tests.controllers.franka_arm.test_cartesian_spring import torques
from tests.controllers.franka_example_controllers.two_arm_station import (
    joints_of,
    start_two_armed_example,
)

YAW = 0.3
PARAMS = {
    arm: {"arm_id": arm[0], "joint_names": joints_of(arm[0])}
    for arm in ("left", "right")
}


@pytest.fixture
def station():
    arms = {
        "l": {"base_xyz": [0.0, 0.5, 0.0]},
        "r": {"base_xyz": [0.0, -0.5, 0.0], "base_rpy": [0.0, 0.0, YAW]},
    }
    return start_two_armed_example("DualArmCartesianImpedance", PARAMS, arms)


def pose(station, arm):
    """Return the end effector's pose in the world."""
    base = np.eye(4)
    base[1, 3] = 0.5 if arm == "l" else -0.5
    if arm == "r":
        base[:2, :2] = [[cos(YAW), -sin(YAW)], [sin(YAW), cos(YAW)]]
    return base @ np.reshape(Arms(station.robots).state(arm).O_T_EE, (4, 4)).T


def right_to_left(station):
    return np.linalg.inv(pose(station, "r")) @ pose(station, "l")


def test_centering_frame_is_in_the_middle(station):
    station.loop.step(50)

    told = station.published("example")["centering_frame"]
    middle = (pose(station, "l")[:3, 3] + pose(station, "r")[:3, 3]) / 2
    assert told["frame_id"] == "l_link0"
    assert told["position"] == pytest.approx(middle - [0.0, 0.5, 0.0], abs=1e-6)
    assert np.linalg.norm(told["orientation"]) == pytest.approx(1.0)


@pytest.mark.slow
def test_relative_pose_is_kept_while_the_centering_frame_moves(station):
    before = right_to_left(station)
    station.loop.step(1_000)
    told = station.published("example")["centering_frame"]
    goal = np.add(told["position"], [0.05, 0.03, 0.04])
    for step in range(1, 21):  # slowly, as a person would pull the frame
        target = told["position"] + step / 20 * (goal - told["position"])
        station.motion.set_command("example", [*target, *told["orientation"]])
        station.loop.step(200)
        moved = right_to_left(station)[:3, 3] - before[:3, 3]
        assert np.linalg.norm(moved) < 0.005
    station.loop.step(1_000)

    now = station.published("example")["centering_frame"]
    assert now["position"] == pytest.approx(goal, abs=1e-3)
    assert right_to_left(station) == pytest.approx(before, abs=2e-3)
    assert station.latest().mode == "move"


@pytest.mark.slow
def test_torques_follow_the_formula(station):
    start = {arm: Arms(station.robots).state(arm) for arm in "lr"}
    station.tuning.set_gains("example", {"right_nullspace_stiffness": 20.0})
    Arms(station.robots).apply_force("r", "r_hand", [3.0, 4.0, 0], [0, 0.5, 0], 10)
    station.loop.step(2_500)

    state = Arms(station.robots).state("r")
    now, then = (np.reshape(s.O_T_EE, (4, 4)).T for s in (state, start["r"]))
    turn = now[:3, :3] @ then[:3, :3].T
    angle = np.arccos((np.trace(turn) - 1) / 2)
    skew = (turn - turn.T) * angle / (2 * np.sin(angle))
    turned = np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
    spring = (now[:3, 3] - then[:3, 3], turned, 200.0, 10.0, 20.0)
    model = Arms(station.robots).model("r", Frame.END_EFFECTOR)
    expected = torques(model, state, spring, np.array(start["r"].q))

    assert angle > 0.01
    commanded = [*station.loop.hw.arms[1].commands.efforts]
    assert commanded == pytest.approx(expected, abs=1e-3)


def test_stiffnesses_of_both_arms_are_gains(station):
    schema = station.tuning.gains("example").schema

    assert schema["left_translational_stiffness"].maximum == 400.0
    assert schema["right_rotational_stiffness"].unit == "Nm/rad"
    assert station.tuning.gains("example").values["left_nullspace_stiffness"] == 0.0


def test_arms_that_are_not_described_together_are_refused(station):
    station.switch_controllers(SwitchRequest((), ("example",)))
    station.parameters.set("robot_description", "<robot><link name='base'/></robot>")
    kind = "franka_example_controllers/DualArmCartesianImpedanceExampleController"
    with pytest.raises(ControllerLoadError, match="no link 'l_link0'"):
        station.load_controller("second", kind, PARAMS)
