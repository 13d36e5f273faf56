"""A client that recovers right after a collision, and at once moves away with torques.

The client is a PD controller around a planned path, as in panda-python.
"""

import numpy as np
import pytest

from station.core.franka import Frame, RobotMode
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.arm.franka_kinematics import zero_jacobian
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.franka_parameters import read_parameters
from station.hw.franka.simulated.franka_world import simulate_one

TORQUES = ControllerMode.EXTERNAL_CONTROLLER, MotionGeneratorMode.NONE
STIFFNESS = np.array([600.0, 600, 600, 600, 250, 150, 50])
DAMPING = np.array([50.0, 50, 50, 20, 20, 20, 10])
TABLE = {
    "name": "table",
    "type": "table",
    "position": [0.45, 0.0, 0.40],
    "size": [0.4, 0.6, 0.05],
}
ROBOT = {"arm_id": "panda", "robot_description": "example-robot-data:panda"}


@pytest.fixture
def arm():
    params = Parameters(ParameterTree({"robot": ROBOT, "scene": {"objects": [TABLE]}}))
    told = read_parameters(params.namespace("robot"))
    return simulate_one(told, params).arms["panda"]


def follow(arm, q, dq):
    """Give the torques towards a point of the path, and let a cycle pass."""
    state = arm.state
    error, rate = np.subtract(q, state.q), np.subtract(dq, state.dq)
    arm.command_joint_torques(list(STIFFNESS * error + DAMPING * rate))
    arm.read_once()


def push_into_the_table(arm, speed):
    """Go down at a speed [m/s] until the arm gives up."""
    arm.start_motion(*TORQUES)
    q, frame = np.array(arm.state.q), arm.state.F_T_EE
    for cycle in range(5000):
        jacobian = zero_jacobian(Frame.END_EFFECTOR, list(q), frame)
        twist = [0, 0, -speed * min(1.0, cycle / 500), 0, 0, 0]
        dq = np.linalg.pinv(np.reshape(jacobian, (7, 6)).T, rcond=1e-3) @ twist
        q = q + 0.001 * dq
        follow(arm, q, dq)
        if arm.state.robot_mode is not RobotMode.MOVE:
            return
    raise AssertionError("there was no collision")


def recover(arm):
    """Recover, as a client does that waits for the answer."""
    arm.automatic_error_recovery()
    while arm.state.robot_mode is RobotMode.AUTOMATIC_ERROR_RECOVERY:
        arm.read_once()
    assert arm.state.robot_mode is RobotMode.IDLE


def move_away(arm, goal):
    """Go to a pose of the joints; return how far the arm was from the path."""
    arm.start_motion(*TORQUES)
    begin, errors = np.array(arm.state.q), []
    for cycle in range(1500):
        share = cycle / 1500
        smooth = share**3 * (10 - 15 * share + 6 * share**2)
        q = begin + (goal - begin) * smooth
        follow(arm, q, np.zeros(7))
        errors.append(np.abs(q - arm.state.q).max())
    assert arm.state.robot_mode is RobotMode.MOVE
    arm.stop_motion()
    return errors


def test_second_collision_is_found_as_the_first_one_was(arm):
    for _ in range(3):
        for _ in range(300):
            arm.read_once()
        start = np.array(arm.state.q)
        push_into_the_table(arm, 0.05)
        (error,) = arm.errors()
        assert (error.name, error.where) == ("cartesian_reflex", "z")
        assert 20.0 < error.value < 30.0
        recover(arm)
        move_away(arm, start)


@pytest.mark.parametrize("speed", [0.1, 0.4])
def test_motion_right_after_the_recovery_is_followed_from_its_first_cycle(arm, speed):
    arm.read_once()
    start = np.array(arm.state.q)
    push_into_the_table(arm, speed)
    assert arm.state.robot_mode is RobotMode.REFLEX
    recover(arm)
    errors = move_away(arm, start)
    # The controller's own lag; torques that do not act yet let it grow to many times.
    assert max(errors[:200]) < 5e-3
    assert errors[-1] < 0.02
