"""Errors of joints between desired and measured states, and their bounds."""

from math import pi

import pytest
from hypothesis import given, strategies as st

from station.controllers.joint_trajectory_controller.execution import (
    JointTracking,
)
from station.core.description.robot_description import JointDescription
from station.core.description.urdf import JointType
from station.core.hardware.interfaces import JointStateGroup, JointStateHandle
from station.core.trajectory import StateTolerances
from station.memory.doubles import doubles, put, zeros
from tests.both_modes import arrays, assert_same, needs_both, numbers

JOINTS = [
    JointDescription("wheel", JointType.CONTINUOUS),
    JointDescription("elbow", JointType.REVOLUTE, -2.9, 2.9),
]


# From 1 s to 3 s: x = 1 + 2 t + 3 t^2, and x = t^5 from 1 s to 2 s.
CURVE = [1.0, 2.0, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0]
POWER = [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]


def track(kind, joints=JOINTS):
    """Return the tracking of joints that are measured at 0."""
    columns = [zeros(len(joints)) for _ in range(3)]
    handles = [JointStateHandle(j.name, *columns, k) for k, j in enumerate(joints)]
    tracking = kind(joints, JointStateGroup(handles))
    for index in range(len(joints)):
        tracking.set_bounds(index, None)
    return tracking


@pytest.fixture
def tracking():
    return track(JointTracking)


def test_only_a_continuous_joint_takes_the_short_way_round(tracking):
    put(tracking.positions, [3.0, 2.8])
    put(tracking.memory.positions, [-3.0, -2.8])
    put(tracking.velocities, [1.0, 0.0])
    put(tracking.memory.velocities, [0.25, 0.5])
    tracking.compare_states()
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
    tracking.load_spline(1, doubles([0.0, 1.0, 0.5, *[0.0] * 5]))
    assert not tracking.follow_splines(0.5, 1.0, 0.0)
    assert tracking.exceeds_bounds() is exceeds


def test_desired_states_lie_side_by_side(tracking):
    put(tracking.desired, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    assert tracking.positions.tolist() == [1.0, 2.0]
    assert tracking.velocities.tolist() == [3.0, 4.0]
    assert tracking.accelerations.tolist() == [5.0, 6.0]


def test_another_speed_scales_the_rates_and_not_the_path():
    slides = [JointDescription(name, JointType.PRISMATIC) for name in "ab"]
    tracking = track(JointTracking, slides)
    for k, spline in enumerate([CURVE, POWER]):
        tracking.load_spline(k, doubles(spline))
    tracking.follow_splines(1.5, 0.5, 2.0)
    assert tracking.desired.tolist() == [
        *(2.75, 0.5**5),
        *(2.5, 2.5 * 0.5**4),
        *(6.0 * 0.25 + 2.0 * 5.0, 5.0 * 0.5**3 + 10 * 0.5**4),
    ]
    assert [*tracking.errors, *tracking.rate_errors] == [*tracking.desired[:4]]


@pytest.mark.parametrize(
    ("time", "bounds", "is_over", "exceeds"),
    [
        (1.5, (2.75, 5.0), False, False),
        (1.5, (2.7, 5.0), False, True),
        (1.5, (2.75, 4.9), False, True),
        (3.5, (17.0, 0.0), True, False),
        (3.5, (16.9, 0.0), True, True),
    ],
)
def test_the_end_and_errors_beyond_bounds_are_found(time, bounds, is_over, exceeds):
    tracking = track(JointTracking, [JointDescription("a", JointType.PRISMATIC)])
    tracking.set_bounds(0, StateTolerances(*bounds))
    tracking.load_spline(0, doubles(CURVE))
    assert tracking.follow_splines(time, 1.0, 0.0) is is_over
    assert tracking.exceeds_bounds() is exceeds


times = st.one_of(st.floats(-1.0, 4.0), numbers)


@needs_both
@given(
    st.lists(st.tuples(times, times, arrays(6)), min_size=1, max_size=4),
    st.tuples(times, numbers, numbers),
)
def test_both_modes_follow_the_same(curves, moment):
    def scenario(module):
        joints = [JointDescription(f"j{k}", JointType.CONTINUOUS) for k in curves]
        tracking = track(module.JointTracking, joints)
        for k, (start, duration, coefficients) in enumerate(curves):
            tracking.load_spline(k, doubles([start, duration, *coefficients]))
        is_over = tracking.follow_splines(*moment)
        return [float(is_over), *tracking.desired, *tracking.errors]

    assert_same("execution", scenario)
