"""Ideal joints do what they are commanded."""

import math

import pytest

from station.core.hardware.interfaces import (
    EffortJointInterface,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.hw.mock import POSITION_MODES, MockJoints


def joint(mode, **constants):
    joints = MockJoints([1.0], **constants)
    joints.mode[0] = mode
    return joints


def test_an_idle_joint_stands_still():
    joints = joint("")
    joints.effort_command[0] = joints.velocity_command[0] = 5.0

    joints.advance(0.1)

    assert (joints.position, joints.velocity, joints.effort) == ([1.0], [0.0], [0.0])


@pytest.mark.parametrize("mode", sorted(POSITION_MODES))
def test_a_position_is_reached_in_one_cycle(mode):
    joints = joint(mode)
    joints.position_command[0] = 1.5

    joints.advance(0.1)

    assert joints.position == [1.5]
    assert joints.velocity == [pytest.approx(5.0)]


def test_a_velocity_is_integrated():
    joints = joint(VelocityJointInterface.type_name)
    joints.velocity_command[0] = 2.0

    for _ in range(10):
        joints.advance(0.1)

    assert joints.position[0] == pytest.approx(3.0)
    assert joints.velocity == [2.0]


def test_an_effort_accelerates_like_its_closed_form():
    joints = joint(EffortJointInterface.type_name, inertia=2.0, damping=3.0)
    joints.effort_command[0] = 6.0

    for _ in range(10_000):
        joints.advance(1e-4)

    # tau = J dv/dt + d v from rest: v(t) = tau/d (1 - exp(-d t/J)).
    exact = 6.0 / 3.0 * (1.0 - math.exp(-3.0 / 2.0))
    assert joints.velocity[0] == pytest.approx(exact, rel=1e-4)  # first order in dt


@pytest.mark.parametrize("period", [0.001, 1.0, 1000.0])
def test_friction_is_stable_for_every_period(period):
    joints = joint(EffortJointInterface.type_name)
    joints.velocity[0] = 10.0

    for _ in range(100):
        joints.advance(period)

    assert 0.0 <= joints.velocity[0] < 10.0


def test_nothing_happens_in_no_time():
    joints = joint(PositionJointInterface.type_name)

    joints.advance(0.0)

    assert joints.velocity == [0.0]
