"""What is a transform."""

import pytest

from station.core.errors import InvalidCommandError
from station.hw.franka.arm.franka_kinematics import IDENTITY
from station.hw.franka.arm.transform_check import (
    check_transform,
    transform_problem,
)


@pytest.mark.parametrize(
    ("index", "value", "problem"),
    [
        (15, 2.0, "last row"),
        (3, 1e-9, "last row"),
        (0, 1.00002, "length 1"),
        (12, float("nan"), "finite"),
    ],
)
def test_a_matrix_that_is_no_transform_is_refused_with_the_reason(
    index, value, problem
):
    pose = list(IDENTITY)
    pose[index] = value
    assert problem in transform_problem(pose)
    with pytest.raises(InvalidCommandError, match=problem):
        check_transform(pose, "X")


def test_small_deviations_pass():
    # 0.7071 instead of the root of 1/2, as configurations have it.
    pose = [0.7071, -0.7071, 0, 0, 0.7071, 0.7071, 0, 0, *IDENTITY[8:]]
    assert transform_problem(pose) is None
    assert check_transform(pose, "X") == pose


@pytest.mark.parametrize(
    "rotation",
    [
        [-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],  # a mirror
        # unit rows and columns, not at right angles
        [0.6, 0.8, 0.0, 0.8, 0.6, 0.0, 0.0, 0.0, 1.0],
    ],
)
def test_frames_that_stay_have_a_right_handed_base(rotation):
    x, y, z = rotation[0:3], rotation[3:6], rotation[6:9]
    pose = [*x, 0.0, *y, 0.0, *z, 0.0, 0.0, 0.0, 0.1, 1.0]
    assert transform_problem(pose) is None
    with pytest.raises(InvalidCommandError, match="right-handed"):
        check_transform(pose, "X")


def test_an_origin_in_millimetres_is_refused():
    pose = [*IDENTITY[:12], 0.0, 0.0, 103.4, 1.0]
    with pytest.raises(InvalidCommandError, match="at most 10 m away"):
        check_transform(pose, "NE_T_EE")
