"""A step far from all limits: one call against the single functions, in both modes."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from station.controllers.cartesian_motion import linear_kinematics
from station.core.franka import Frame
from station.hw.franka.arm.franka_kinematics import frame_pose, zero_jacobian
from station.memory.doubles import doubles, put, zeros
from tests.both_modes import arrays, assert_same, needs_both, sibling

Q = [0.2, -0.6, 0.3, -2.0, 0.4, 1.7, 0.5]
LOWER, UPPER = [value - 0.5 for value in Q], [value + 0.5 for value in Q]
SLOW = [0.05, 0.0, 0.02, 0.0, 0.1, 0.0]


class Predicted:
    """An arm at joint positions whose end effector moves at a twist."""

    def __init__(self, module, q, twist=SLOW, accelerations=(0.0,) * 6, **bounds):
        motions = sibling(module, "cartesian_motion_generator")
        pose = frame_pose(Frame.END_EFFECTOR, q)
        self.pose, self.new = doubles(pose), zeros(7)
        self.twist, self.accelerations = zeros(6), zeros(12)
        self.motion = motions.PoseMotion(
            doubles(pose),
            zeros(16),
            self.twist,
            self.accelerations,
            largest=[1.0] * 6,
            jerk=[20.0] * 6,
            speeds=bounds.get("speeds", (1.0, 2.0)),
        )
        self.motion.take_rates(list(twist), list(accelerations))
        self.prediction = module.StopPrediction(
            self.pose,
            self.new,
            lower=bounds.get("lower", LOWER),
            upper=bounds.get("upper", UPPER),
        )
        self.q_d = doubles(q)
        self.prediction.start_at_rest(self.q_d)
        self.prediction.note_clearance(bounds.get("room", 0.5))
        kinematics = module.LinearKinematics(
            doubles(q),
            doubles(zero_jacobian(Frame.END_EFFECTOR, q)),
            doubles(bounds.get("velocity", [1.0] * 7)),
            doubles(bounds.get("acceleration", [10.0] * 7)),
        )
        kinematics.invert()
        self.prediction.present = self.prediction.resting = kinematics

    def fastest_joint(self):
        """Return the joint that exceeds its bounds most, where the arm is or rests."""
        return max(
            each.fastest_joint(self.twist, self.accelerations)
            for each in (self.prediction.present, self.prediction.resting)
        )

    def passes_one_by_one(self):
        """Return whether every single test finds the step far from its limit."""
        it, motion = self.prediction, self.motion
        return not (
            it.leads_away(motion)
            or motion.is_at_rest()
            or it.has_left()
            or it.limited_joint() >= 0
            or it.may_collide()
            or self.fastest_joint() >= 0
            or not motion.stays_within_speed()
        )


def predicted(**bounds):
    return Predicted(linear_kinematics, Q, **bounds)


def test_the_joints_would_rest_where_the_end_effector_would():
    it = predicted()

    assert it.prediction.passes(it.motion)
    ended = frame_pose(Frame.END_EFFECTOR, it.new.tolist())
    it.motion.brake()
    # Second order in a way of some millimetres.
    assert ended == pytest.approx([*it.motion.resting], abs=1e-4)
    assert ended != pytest.approx([*it.pose], abs=1e-4)
    assert it.new[2] == Q[2]


def test_a_step_in_the_middle_passes():
    it = predicted()

    assert it.passes_one_by_one()
    assert it.prediction.passes(it.motion)


@pytest.mark.parametrize(
    "near",
    [
        {"twist": [0.0] * 6},
        {"twist": [0.3, 0.0, 0.0, 0.0, 0.0, 0.0]},
        {"lower": [*LOWER[:3], Q[3] - 1e-6, *LOWER[4:]], "upper": [9.0] * 7}
        | {"twist": [-0.05, 0.0, 0.0, 0.0, 0.0, 0.0]},
        {"room": 0.0, "twist": [0.1, 0.0, 0.0, 0.0, 0.0, 0.0]},
        {"velocity": [1e-3] * 7},
        {"acceleration": [1e-3] * 7},
        {"speeds": (0.01, 2.0)},
        {"speeds": (1.0, 0.01)},
        {"twist": [float("nan")] * 6},
    ],
)
def test_a_step_near_a_limit_is_left_undecided(near):
    it = predicted(**near)

    assert not it.passes_one_by_one()
    assert not it.prediction.passes(it.motion)


def test_an_arm_that_has_left_its_configuration_is_looked_at():
    it = predicted()
    it.q_d[0] += 0.02

    assert it.prediction.has_left()
    assert not it.prediction.passes(it.motion)


def test_a_joint_beyond_a_limit_may_come_back_only():
    it = predicted(lower=[-1.0] * 7, upper=[1.0] * 7)

    def limited(new, before):
        put(it.new, before + [0.0] * 5)
        it.prediction.accept()
        put(it.new, new + [0.0] * 5)
        return it.prediction.limited_joint()

    assert limited([0.0, 1.1], [0.0, 1.2]) == -1
    assert limited([0.0, 1.1], [0.0, 1.1]) == -1
    assert limited([0.0, 1.2], [0.0, 1.1]) == 1
    assert limited([-1.2, 1.2], [-1.1, 1.1]) == 0
    assert limited([1.0, -1.0], [0.0, 0.0]) == -1


rates = st.lists(st.floats(-0.3, 0.3), min_size=6, max_size=6)


@given(rates, rates, st.floats(0.0, 0.05), st.floats(0.05, 2.0))
def test_one_call_says_what_the_single_tests_say(twist, accelerations, room, bound):
    it = predicted(
        twist=twist,
        accelerations=accelerations,
        room=room,
        velocity=[bound] * 7,
        acceleration=[5.0 * bound] * 7,
        speeds=(0.4, 0.4),
    )

    assert it.passes_one_by_one() == it.prediction.passes(it.motion)


@needs_both
@settings(max_examples=100)
@given(arrays(7), arrays(6), arrays(6), st.lists(rates, max_size=3))
def test_both_modes_agree_bit_for_bit(q, twist, accelerations, more):
    def scenario(module):
        it = Predicted(module, Q if more else q, twist, accelerations)
        prediction, found = it.prediction, []
        for each in (twist, *more):
            it.motion.take_rates(each, accelerations)
            found += [prediction.leads_away(it.motion), *it.new, prediction.has_left()]
            found += [prediction.limited_joint(), prediction.may_collide()]
            found += [it.fastest_joint()]
            found += [prediction.passes(it.motion), *it.new]
        return found

    assert_same("linear_kinematics", scenario)


@settings(max_examples=200, deadline=None)
@given(
    twist=st.lists(st.floats(-0.3, 0.3), min_size=6, max_size=6),
    accelerations=st.lists(st.floats(-2.0, 2.0), min_size=12, max_size=12),
    velocity=st.floats(0.05, 2.0),
    acceleration=st.floats(0.5, 20.0),
)
def test_joints_that_are_slow_beyond_doubt_exceed_no_bound(
    twist, accelerations, velocity, acceleration
):
    joints, rates = predicted().prediction.present, doubles(twist)
    joints.velocity = doubles([velocity] * 7)
    joints.acceleration = doubles([acceleration] * 7)
    push = max(np.linalg.norm(accelerations[:6]), np.linalg.norm(accelerations[6:]))
    if joints.are_slow(rates, push):
        assert joints.fastest_joint(rates, doubles(accelerations)) == -1


def test_a_slow_hand_is_slow_beyond_doubt():
    joints = predicted().prediction.present
    assert joints.are_slow(doubles(SLOW), 1.0)
    assert not joints.are_slow(doubles(SLOW), 100.0)
    joints.velocity = doubles([0.01] * 7)
    assert not joints.are_slow(doubles(SLOW), 1.0)
