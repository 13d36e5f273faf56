"""Filter and rate limits of poses and twists: the same bits in both modes."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from station.core.franka import Frame
from station.hw.franka.arm.franka_kinematics import frame_pose
from station.hw.franka.commands.pose_rates import PoseRates
from station.memory.doubles import doubles, put, zeros
from tests.both_modes import arrays, assert_same, needs_both

POSE = frame_pose(Frame.END_EFFECTOR, [0.0, -0.8, 0.0, -2.3, 0.0, 1.5, 0.8])
BOUNDS = {"translation": [1.7, 13.0, 6500.0], "rotation": [2.5, 25.0, 12500.0]}


def rates_of(module, twist, acceleration):
    return module.PoseRates(
        doubles(POSE),
        doubles(twist),
        doubles(acceleration),
        **BOUNDS,
        pose_share=0.99,
        period=0.001,
    )


@needs_both
@settings(max_examples=60, deadline=None)
@given(
    gain=st.sampled_from([0.386, 1.0]),
    limits=st.booleans(),
    passes=st.booleans(),
    state=arrays(12),
    command=arrays(6),
)
def test_both_modes_give_the_same_bits(gain, limits, passes, state, command):
    def scenario(module):
        rates = rates_of(module, state[:6], state[6:])
        rates.gain, rates.is_limiting = gain, limits
        pose = doubles(POSE)
        put(pose[12:15], command[:3])
        rates.filter_pose(pose, passes)
        rates.filter_twist(doubles(command))
        return [*rates.sent_pose, *rates.sent_twist]

    assert_same("pose_rates", scenario)


def test_without_filter_and_limits_everything_passes():
    rates = PoseRates(
        doubles(POSE), zeros(6), zeros(6), **BOUNDS, pose_share=0.99, period=0.001
    )
    pose = [*POSE[:12], 5.0, 6.0, 7.0, 1.0]
    passes = False
    rates.filter_pose(doubles(pose), passes)
    rates.filter_twist(doubles([9.0] * 6))
    assert [*rates.sent_pose] == pytest.approx(pose)
    assert [*rates.sent_twist] == [9.0] * 6
