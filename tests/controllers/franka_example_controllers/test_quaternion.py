"""Quaternions against rotation matrices."""

from math import cos, sin

import numpy as np
import pytest

from station.controllers.franka_example_controllers.cartesian_impedance_controllers import (  # noqa: E501
    matrix_of,
    quaternion_of,
)

AXES = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.6, 0.0, -0.8)]


def rotation(axis, angle):
    x, y, z = axis
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + sin(angle) * skew + (1 - cos(angle)) * skew @ skew


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("angle", [0.0, 1e-6, 0.7, 3.1, 3.141592653589793])
def test_quaternion_has_half_the_angle(axis, angle):
    found = quaternion_of(rotation(axis, angle))

    expected = np.array([cos(angle / 2), *(sin(angle / 2) * v for v in axis)])
    assert abs(found @ expected) == pytest.approx(1.0)


@pytest.mark.parametrize("axis", AXES)
def test_matrix_is_that_of_the_rotation(axis):
    turned = rotation(axis, 0.7)

    assert matrix_of(quaternion_of(turned)) == pytest.approx(turned)
