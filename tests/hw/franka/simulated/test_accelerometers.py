"""Accelerometers against finite differences of where their boards are."""

import math

import numpy as np
import pinocchio as pin
import pytest

from station.core.description.robot_files import load_robot_files
from station.core.franka import Frame, RobotState
from station.core.franka.joint_memory import JointMemory
from station.hw.franka.arm.franka_kinematics import frame_pose
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.simulated.accelerometers import Accelerometers
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate

# Of libfranka's test/fr3.urdf: xyz and the roll of each joint linkN_accelerometer_….
TOP = [
    ((0, 0, 0.05), 3.14159),
    ((0, -0.1, 0), 1.5708),
    ((0, -0.13, 0), -1.5708),
    ((0.0825, 0.05, 0), -1.5708),
    ((-0.0825, 0.05, 0), 1.5708),
    ((0, 0.11, 0), -1.5708),
]
BOTTOM = [
    ((0, 0, 0.06), 0),
    ((0, -0.09, 0), -1.5708),
    ((0, -0.14, 0), 1.5708),
    ((0.0825, 0.04, 0), 1.5708),
    ((-0.0825, 0.06, 0), -1.5708),
    ((0, 0.1, 0), 1.5708),
]
GRAVITY = np.array([0.0, 0.0, -9.81])


def board_pose(board: int, side, q) -> pin.SE3:
    """Return where a sensor is in the base frame."""
    link = pin.SE3.Identity()
    if board:
        matrix = frame_pose(list(Frame)[board - 1], list(q))
        link = pin.SE3(np.reshape(matrix, (4, 4)).T.copy())
    place, roll = side[board]
    return link * pin.SE3(pin.utils.rotate("x", roll), np.array(place, float))


def reading_of(poses: list[pin.SE3], period: float) -> np.ndarray:
    """Return what three places, a period apart, mean for the one in the middle."""
    before, here, after = (pose.translation for pose in poses)
    acceleration = (after - 2.0 * here + before) / period**2
    return poses[1].rotation.T @ (acceleration - GRAVITY)


@pytest.mark.parametrize("seed", range(5))
def test_readings_are_second_differences_of_the_boards_places(seed):
    generator, h = np.random.default_rng(seed), 1e-4
    q, dq, ddq = (generator.uniform(-low, low, 7) for low in (2.0, 2.0, 10.0))
    state, memory = RobotState(), JointMemory(7)
    state.O_ddP_O = GRAVITY
    sensors = Accelerometers(state, memory)
    # The velocities of a millisecond ago give the accelerations.
    for age in (1e-3, 0.0):
        state.time = 1.0 - age
        memory.dtheta[:] = memoryview(dq - age * ddq)
        memory.positions[:] = memoryview(q)
        readings = sensors.read()

    times = (-h, 0.0, h)
    for side, found in zip((TOP, BOTTOM), readings, strict=True):
        for board in range(6):
            poses = [
                board_pose(board, side, q + t * dq + t * t / 2.0 * ddq) for t in times
            ]
            # Rounding of a difference of 1e-8 m^2, and the digits of 1.5708.
            assert found[3 * board : 3 * board + 3].tolist() == pytest.approx(
                reading_of(poses, h), abs=2e-3
            )


def test_moving_arm_reads_what_its_motion_says_and_a_resting_one_gravity():
    description = load_robot_files("example-robot-data:panda")
    arm = simulate([ArmPlacement("panda", description)]).arms["panda"]
    arm.read_once()
    for readings in arm.accelerometers():
        norms = np.linalg.norm(np.reshape(readings, (6, 3)), axis=1)
        assert norms == pytest.approx(9.81, abs=1e-6)
    # Upwards: the bottom of the first board looks up, its top down.
    assert arm.accelerometers()[1][2] == pytest.approx(9.81, abs=1e-6)
    assert arm.accelerometers()[0][2] == pytest.approx(-9.81, abs=1e-6)

    arm.start_motion(ControllerMode.JOINT_IMPEDANCE, MotionGeneratorMode.JOINT_VELOCITY)
    places, seen = [], []
    for cycle in range(300):
        rate = 0.3 * math.sin(0.01 * cycle) ** 2
        arm.command_joint_velocities([rate, rate, -rate, rate, -rate, rate, rate])
        arm.read_once()
        places.append(board_pose(5, TOP, arm.state.q))
        seen.append([*arm.accelerometers()[0]][15:])
        # Asked twice in a cycle, the sensors say the same.
        assert [*arm.accelerometers()[0]][15:] == seen[-1]
    # The simulator moves a joint with the velocity at the end of a step, so that the
    # accelerations of a cycle are those of the places around the cycle before.
    for cycle in range(1, 299):
        expected = reading_of(places[cycle - 1 : cycle + 2], arm.cycle_time)
        assert seen[cycle + 1] == pytest.approx(expected, abs=0.02)
    assert np.ptp(seen, axis=0).max() > 0.5


def test_reset_of_the_world_is_no_blow():
    description = load_robot_files("example-robot-data:panda")
    world = simulate([ArmPlacement("panda", description)])
    arm = world.arms["panda"]
    arm.start_motion(ControllerMode.JOINT_IMPEDANCE, MotionGeneratorMode.JOINT_VELOCITY)
    for cycle in range(500):
        arm.command_joint_velocities([0.001 * cycle] + [0.0] * 6)
        arm.read_once()
    arm.accelerometers()
    world.reset({})
    arm.read_once()
    # Without the reset: 0.5 rad/s of joint 1 in a cycle, 50 m/s^2 at 0.1 m.
    norms = np.linalg.norm(np.reshape(arm.accelerometers()[0], (6, 3)), axis=1)
    assert norms == pytest.approx(9.81, abs=0.05)
