"""Errors of joints between desired and measured states, and their bounds."""

from math import pi

import pytest

from station.controllers.joint_trajectory_controller.joint_tracking import (
    JointTracking,
)
from station.core.description.robot_description import JointDescription
from station.core.description.urdf import JointType
from station.core.hardware.interfaces import JointStateGroup, JointStateHandle
from station.core.trajectory import StateTolerances
from station.core.trajectory.splines import EXCEEDS
from station.memory.doubles import doubles, put, zeros

JOINTS = [
    JointDescription("wheel", JointType.CONTINUOUS),
    JointDescription("elbow", JointType.REVOLUTE, -2.9, 2.9),
]


@pytest.fixture
def tracking():
    columns = zeros(2), zeros(2), zeros(2)
    handles = [JointStateHandle(j.name, *columns, k) for k, j in enumerate(JOINTS)]
    tracking = JointTracking(JOINTS, JointStateGroup(handles))
    for index in range(2):
        tracking.set_bounds(index, None)
    return tracking


def test_only_a_continuous_joint_takes_the_short_way_round(tracking):
    put(tracking.positions, [3.0, 2.8])
    put(tracking.memory.positions, [-3.0, -2.8])
    put(tracking.velocities, [1.0, 0.0])
    put(tracking.memory.velocities, [0.25, 0.5])
    tracking.splines.compare()
    assert list(tracking.errors) == pytest.approx([6.0 - 2 * pi, 5.6])
    assert list(tracking.rate_errors) == [0.75, -0.5]


@pytest.mark.parametrize(
    ("bounds", "exceeds"),
    [
        (None, False),
        (StateTolerances(0.6, 0.6), False),
        (StateTolerances(0.4, 0.0), True),
        (StateTolerances(0.0, 0.4), True),
        (StateTolerances(0.0, 0.0), False),
    ],
)
def test_a_bound_of_zero_is_no_bound(tracking, bounds, exceeds):
    put(tracking.memory.velocities, [0.0, 0.5])
    tracking.set_bounds(1, bounds)
    tracking.splines.load(1, doubles([0.0, 1.0, 0.5, *[0.0] * 5]))
    mask = tracking.splines.follow(0.5, 1.0, 0.0)
    assert mask == (EXCEEDS if exceeds else 0)


def test_desired_states_lie_side_by_side(tracking):
    put(tracking.desired, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    assert tracking.positions.tolist() == [1.0, 2.0]
    assert tracking.velocities.tolist() == [3.0, 4.0]
    assert tracking.accelerations.tolist() == [5.0, 6.0]
