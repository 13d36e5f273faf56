"""Both modes; what it computes is tested with its controller.

`tests/controllers/cartesian_motion/test_arm_configuration.py` compares the motions with
finite differences.
"""

import pytest
from hypothesis import given, settings, strategies as st

from station.controllers.cartesian_motion.linear_kinematics import way_between
from station.memory.doubles import doubles, zeros
from tests.both_modes import arrays, assert_same, needs_both, numbers

bounds = st.lists(st.floats(0.01, 5.0), min_size=7, max_size=7)


def test_the_way_between_positions_adds_up_over_the_joints():
    assert way_between(doubles([1, 2]), doubles([3, 1.5])) == pytest.approx(2.5)


@needs_both
@settings(max_examples=60)
@given(arrays(42), arrays(7), arrays(18), bounds, numbers)
def test_both_modes_agree_bit_for_bit(jacobian, q, motions, limits, elbow):
    def scenario(module):
        step, drift, rates = zeros(7), zeros(6), zeros(7)
        kernel = module.LinearKinematics(
            doubles(q), doubles(jacobian), doubles(limits), doubles(limits)
        )
        twist, accelerations = doubles(motions[:6]), doubles(motions[6:])
        kernel.invert()
        kernel.joint_step(twist, elbow, step)
        kernel.write_joint_rates(accelerations[:6], rates)
        kernel.drift(doubles(q), drift)
        found = kernel.fastest_joint(twist, accelerations)
        found_dexterous = [kernel.is_dexterous(each) for each in (0.05, elbow)]
        way = module.way_between(step, rates)
        return [found, *step, *drift, *rates, way, *found_dexterous]

    assert_same("linear_kinematics", scenario)
