"""Both modes; what it computes is tested with its controller.

`tests/controllers/cartesian_motion/test_arm_configuration.py` compares the motions with
finite differences.
"""

import pytest
from hypothesis import given, settings, strategies as st

from station.controllers.cartesian_motion.linear_kinematics import (
    limited_joint,
    moved,
    way_between,
)
from station.memory.doubles import doubles, zeros
from tests.both_modes import arrays, assert_same, needs_both, numbers

bounds = st.lists(st.floats(0.01, 5.0), min_size=7, max_size=7)


def test_the_way_between_positions_adds_up_over_the_joints():
    assert way_between(doubles([1, 2]), doubles([3, 1.5])) == pytest.approx(2.5)


def test_a_joint_beyond_a_bound_may_come_back_only():
    lower, upper = doubles([-1.0, -1.0]), doubles([1.0, 1.0])

    def limited(q, last):
        return limited_joint(doubles(q), doubles(last), lower, upper)

    assert limited([0.0, 1.1], [0.0, 1.2]) == -1
    assert limited([0.0, 1.1], [0.0, 1.1]) == -1
    assert limited([0.0, 1.2], [0.0, 1.1]) == 1
    assert limited([-1.2, 1.2], [-1.1, 1.1]) == 0
    assert limited([1.0, -1.0], [0.0, 0.0]) == -1


def test_a_step_moves_and_tells_its_largest_change():
    result = zeros(3)

    assert moved(doubles([1, 2, 3]), doubles([0.1, -0.4, 0]), result) == 0.4
    assert result.tolist() == pytest.approx([1.1, 1.6, 3.0])


@needs_both
@settings(max_examples=60)
@given(arrays(42), arrays(7), arrays(18), bounds, numbers)
def test_both_modes_agree_bit_for_bit(jacobian, q, motions, limits, elbow):
    def scenario(module):
        found, step, drift, rates = zeros(2), zeros(7), zeros(6), zeros(7)
        kernel = module.LinearKinematics(doubles(q), doubles(jacobian))
        twist, accelerations = doubles(motions[:6]), doubles(motions[6:])
        kernel.invert()
        kernel.joint_step(twist, elbow, step)
        kernel.write_joint_rates(accelerations[:6], rates)
        kernel.drift(doubles(q), drift)
        found[0] = kernel.fastest_joint(
            twist, accelerations, doubles(limits), doubles(limits)
        )
        low, high = doubles([-1.0] * 7), doubles([1.0] * 7)
        found[1] = module.limited_joint(step, rates, low, high)
        after = zeros(7)
        found_dexterous = [kernel.is_dexterous(each) for each in (0.05, elbow)]
        sums = [module.way_between(step, rates), module.moved(rates, step, after)]
        return [*found, *step, *drift, *rates, *after, *sums, *found_dexterous]

    assert_same("linear_kinematics", scenario)
