"""Poses and Jacobians against published vectors, finite differences and MuJoCo."""

from math import cos, pi, sin

import numpy as np
import pytest

from station.core.description.robot_files import load_robot_files
from station.core.franka.franka_model import Frame
from station.hw.franka.arm.franka_kinematics import (
    IDENTITY,
    compose,
    frame_pose,
    zero_jacobian,
)
from station.hw.franka.franka_parameters import INITIAL_POSITIONS
from station.hw.franka.simulated.arm_model import ArmModel
from station.hw.franka.simulated.franka_world import (
    ArmPlacement,
    simulate,
)

MODEL = ArmModel(load_robot_files("example-robot-data:panda"))
# Test configuration of franka_hw and the answers for the flange, printed to 6 digits.
Q = [
    0.5157262388785411,
    1.2140897359597562,
    1.5346381355065786,
    -3.0398301021734246,
    -1.2930720893855998,
    1.332867311125138,
    -1.5554459725458225,
]
FLANGE = [
    [0.281895, -0.741623, 0.608712, -0.144822],
    [-0.927236, -0.373590, -0.025759, 0.114741],
    [0.246513, -0.557158, -0.792973, 0.172440],
]
ZERO_JACOBIAN = [
    [-0.114741, -0.139677, -0.114265, -0.134655, 0.036575, -0.132448, 0.0],
    [-0.144822, -0.079183, 0.080314, 0.425783, -0.114922, -0.039226, 0.0],
    [0.0, 0.069399, 0.160459, 0.017734, 0.031810, 0.010578, 0.0],
    [0.0, -0.493167, 0.815174, 0.321402, -0.859908, -0.293245, 0.608712],
    [0.0, 0.869935, 0.462123, 0.140648, -0.370783, 0.921392, -0.025759],
    [1.0, 0.0, 0.349190, -0.936439, -0.350825, -0.255036, -0.792973],
]
BODY_JACOBIAN = [
    [0.101939, 0.051155, -0.067126, -0.428388, 0.124712, 0.001642, 0.0],
    [0.139199, 0.094504, -0.034664, -0.069086, -0.001915, 0.106987, 0.0],
    [-0.066114, -0.138015, -0.198863, -0.106997, 0.0, -0.088, 0.0],
    [0.246513, -0.945656, -0.112624, -0.270656, 0.014917, -0.999882, 0.0],
    [-0.557158, 0.040745, -0.971751, 0.230841, 0.971714, 0.015350, 0.0],
    [-0.792973, -0.322605, 0.207404, 0.934590, -0.235690, 0.0, 1.0],
]
# The hand: turned by -45 degrees about z, its tip 0.1034 m ahead.
HALF = cos(pi / 4)
F_T_EE = [HALF, -HALF, 0, 0, HALF, HALF, 0, 0, 0, 0, 1, 0, 0, 0, 0.1034, 1]
C, S = cos(0.3), sin(0.3)
EE_T_K = [1, 0, 0, 0, 0, C, S, 0, 0, -S, C, 0, 0.01, 0.02, 0.03, 1]


def matrix(flat: list[float], columns: int) -> np.ndarray:
    return np.reshape(flat, (columns, -1)).T


def test_flange_and_its_jacobians_are_the_published_ones() -> None:
    pose = matrix(frame_pose(Frame.FLANGE, Q), 4)
    assert pose[:3] == pytest.approx(np.array(FLANGE), abs=1e-6)
    zero = matrix(zero_jacobian(Frame.FLANGE, Q), 7)
    assert zero == pytest.approx(np.array(ZERO_JACOBIAN), abs=1e-6)
    body = matrix(MODEL.body_jacobian(Frame.FLANGE, Q, IDENTITY, IDENTITY), 7)
    assert body == pytest.approx(np.array(BODY_JACOBIAN), abs=1e-6)


@pytest.mark.parametrize(
    ("frame", "origin"),
    [
        (Frame.JOINT1, (0.0, 0.0, 0.333)),
        (Frame.JOINT3, (0.0, 0.0, 0.649)),
        (Frame.JOINT4, (0.0825, 0.0, 0.649)),
        (Frame.JOINT5, (0.0, 0.0, 1.033)),
        (Frame.JOINT6, (0.0, 0.0, 1.033)),
        (Frame.JOINT7, (0.088, 0.0, 1.033)),
        (Frame.FLANGE, (0.088, 0.0, 0.926)),
    ],
)
def test_origins_of_the_stretched_arm(
    frame: Frame, origin: tuple[float, float, float]
) -> None:
    assert frame_pose(frame, [0.0] * 7)[12:15] == pytest.approx(origin, abs=1e-12)


def test_flange_of_the_stretched_arm_points_down() -> None:
    rotation = matrix(frame_pose(Frame.FLANGE, [0.0] * 7), 4)[:3, :3]
    assert rotation == pytest.approx(np.diag([1.0, -1.0, -1.0]), abs=1e-12)


def test_flange_pose_at_the_start_equals_the_published_pose() -> None:
    origin = frame_pose(Frame.FLANGE, INITIAL_POSITIONS)[12:15]
    assert origin == pytest.approx([0.306891, 0.0, 0.590282], abs=1e-6)


def test_hand_at_the_start_pose_points_down() -> None:
    pose = frame_pose(Frame.END_EFFECTOR, INITIAL_POSITIONS, F_T_EE)
    assert pose[12:15] == pytest.approx([0.306891, 0.0, 0.486882], abs=1e-6)
    down = np.diag([1.0, -1.0, -1.0])
    assert matrix(pose, 4)[:3, :3] == pytest.approx(down, abs=1e-12)


@pytest.mark.parametrize("frame", list(Frame))
def test_zero_jacobian_is_the_derivative_of_the_pose(frame: Frame) -> None:
    step = 1e-6
    jacobian = matrix(zero_jacobian(frame, Q, F_T_EE, EE_T_K), 7)
    rotation = matrix(frame_pose(frame, Q, F_T_EE, EE_T_K), 4)[:3, :3]
    for joint in range(7):
        ends = []
        for sign in (1.0, -1.0):
            moved = list(Q)
            moved[joint] += sign * step
            ends.append(matrix(frame_pose(frame, moved, F_T_EE, EE_T_K), 4))
        rate = (ends[0] - ends[1]) / (2.0 * step)
        spin = rate[:3, :3] @ rotation.T
        twist = [*rate[:3, 3], spin[2, 1], spin[0, 2], spin[1, 0]]
        # Rounding 1e-16 / 1e-6 and the third derivative times 1e-12.
        assert jacobian[:, joint] == pytest.approx(twist, abs=1e-8)


@pytest.mark.parametrize("frame", list(Frame))
def test_body_jacobian_is_the_zero_jacobian_in_own_axes(frame: Frame) -> None:
    rotation = matrix(frame_pose(frame, Q, F_T_EE, EE_T_K), 4)[:3, :3]
    turned = np.kron(np.eye(2), rotation.T) @ matrix(
        zero_jacobian(frame, Q, F_T_EE, EE_T_K), 7
    )
    body = matrix(MODEL.body_jacobian(frame, Q, F_T_EE, EE_T_K), 7)
    assert body == pytest.approx(turned, abs=1e-12)


def test_poses_agree_with_the_simulation() -> None:
    description = load_robot_files("example-robot-data:panda")
    simulation = simulate([ArmPlacement("panda", description, positions=tuple(Q))])
    data = simulation.world.data
    for frame in list(Frame)[:7]:
        body = data.body(f"panda_link{frame.value + 1}")
        pose = matrix(frame_pose(frame, Q), 4)
        assert pose[:3, 3] == pytest.approx(body.xpos, abs=1e-12)
        assert pose[:3, :3].ravel() == pytest.approx(body.xmat, abs=1e-12)


def test_identity_composes_to_the_other() -> None:
    assert compose(IDENTITY, F_T_EE) == pytest.approx(F_T_EE)
    assert compose(F_T_EE, IDENTITY) == pytest.approx(F_T_EE)
