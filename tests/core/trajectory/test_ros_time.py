"""Whole nanoseconds become seconds as the original converts them, in both modes."""

from hypothesis import given, strategies as st

from station.core.trajectory.ros_time import to_seconds
from tests.both_modes import assert_same, needs_both


@given(st.one_of(st.integers(-(10**15), 10**18), st.integers(-(10**300), 10**300)))
def test_seconds_are_whole_seconds_plus_the_rest(nanoseconds):
    seconds, rest = divmod(nanoseconds, 10**9)
    assert to_seconds(nanoseconds) == seconds + 1e-9 * rest


@needs_both
@given(st.one_of(st.integers(-(10**15), 10**18), st.integers(-(10**300), 10**300)))
def test_both_modes_convert_the_same(nanoseconds):
    assert_same("ros_time", lambda module: [module.to_seconds(nanoseconds)])
