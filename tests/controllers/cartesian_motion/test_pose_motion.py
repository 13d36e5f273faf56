"""A pose along its axes, its ways to rest against Ruckig, and both modes."""

import pytest
from hypothesis import given, settings, strategies as st

from station.controllers.cartesian_motion.cartesian_motion_generator import (
    PoseMotion,
    peak_speed,
)
from station.controllers.smoothed_motion.axis_limits import AxisLimits
from station.controllers.smoothed_motion.motion_generator import MotionGenerator
from station.core.numerics.poses import displace, pose_of, rotation_between
from station.memory.doubles import doubles, zeros
from tests.both_modes import arrays, assert_same, needs_both, numbers

LARGEST, JERK = [0.5] * 3 + [1.5] * 3, [6.0] * 3 + [15.0] * 3
SPEEDS = (0.3, 1.0)
HERE = pose_of([0.3, 0.1, 0.5], [0.6, 0.0, 0.0, 0.8])
axes = st.lists(st.floats(-0.4, 0.4), min_size=6, max_size=6)
states = st.tuples(st.floats(-1.0, 1.0), st.floats(-2.0, 2.0))
limits = st.tuples(st.floats(2.0, 5.0), st.floats(1.0, 80.0))


class Moved:
    """A motion with its memory."""

    def __init__(
        self, kind=PoseMotion, pose=HERE, target=HERE, largest=LARGEST, jerk=JERK
    ):
        self.pose, self.target = doubles(pose), doubles(target)
        self.twist, self.accelerations = zeros(6), zeros(12)
        self.motion = kind(
            self.pose,
            self.target,
            self.twist,
            self.accelerations,
            largest=largest,
            jerk=jerk,
            speeds=SPEEDS,
        )


def test_the_way_to_the_target_begins_at_the_present_orientation():
    target = displace(HERE, (0.1, -0.2, 0.3), (0.0, 0.4, 0.2))
    it = Moved(target=target)

    assert it.motion.coordinates() == [*HERE[12:15], 0.0, 0.0, 0.0]
    assert it.motion.aim() == [*target[12:15], *rotation_between(HERE, target)]


@given(axes, axes, axes)
def test_a_pose_goes_where_its_axes_go_and_back(way, velocities, accelerations):
    it = Moved()
    it.motion.take_rates([0.1] * 6, [0.2] * 6)
    before = [*it.pose, *it.twist, *it.accelerations]
    positions = [*(a + b for a, b in zip(HERE[12:15], way[:3], strict=True)), *way[3:]]
    coordinates = it.motion.move(positions, velocities, accelerations)

    assert [*it.pose] == pytest.approx(displace(HERE, way[:3], way[3:]), abs=1e-12)
    assert coordinates == [*it.pose[12:15], 0.0, 0.0, 0.0]
    assert [*it.twist, *it.accelerations[:6]] == [*velocities, *accelerations]
    it.motion.undo([0.1] * 6, [0.2] * 6)
    assert [*it.pose, *it.twist, *it.accelerations] == before


@given(states, limits)
def test_the_way_to_rest_is_that_of_the_time_optimal_motion(state, limit):
    (v, a), (largest, jerk) = state, limit
    generator = MotionGenerator(AxisLimits((1.0,), (largest,), (jerk,)))
    generator.start([0.0], [0.0])
    generator.restore(([0.0], [v], [a]))
    it = Moved(largest=[largest] * 6, jerk=[jerk] * 6)
    it.motion.take_rates([v] + [0.0] * 5, [a] + [0.0] * 5)
    it.motion.brake()

    way = it.motion.resting[12] - HERE[12]
    assert way == pytest.approx(generator.resting_positions()[0], abs=1e-7)


@given(axes, axes)
def test_a_motion_that_brakes_stays_within_its_speeds_if_its_axes_do(velocities, a):
    it = Moved()
    it.motion.take_rates(velocities, a)
    v, a, jerk = map(doubles, (velocities, a, JERK))

    assert it.motion.stays_within_speed() == all(
        peak_speed(v[k : k + 3], a[k : k + 3], jerk[k : k + 3]) <= speed
        for k, speed in zip((0, 3), SPEEDS, strict=True)
    )


def test_peaks_are_against_the_velocities_and_limited():
    it = Moved(largest=[1.5, 9.0] + [1.0] * 4, jerk=[8.0] * 6)
    it.motion.take_rates([2.0, -0.5] + [0.0] * 4, [0.0] * 6)

    assert it.accelerations[6:8].tolist() == [-1.5, 2.0]


def test_an_axis_that_accelerates_becomes_faster_while_it_brakes():
    jerk = doubles([4.0, 4.0])

    assert peak_speed(doubles([3, 0]), doubles([0, 0]), jerk) == 3.0
    assert peak_speed(doubles([2.5, 0]), doubles([2, 0]), jerk) == 3.0
    assert peak_speed(doubles([0, 4]), doubles([4, 0]), jerk) == pytest.approx(20**0.5)


@pytest.mark.parametrize("axis", range(12))
def test_one_axis_that_moves_or_accelerates_is_no_rest(axis):
    it, rates = Moved(), [0.0] * 12
    it.motion.take_rates(rates[:6], rates[6:])
    assert it.motion.is_at_rest()
    rates[axis] = -2e-12
    it.motion.take_rates(rates[:6], rates[6:])
    assert not it.motion.is_at_rest()


def test_lists_are_new_only_when_their_numbers_are():
    it, still = Moved(pose=HERE, target=HERE), [0.0] * 6
    aim = it.motion.aim()
    assert it.motion.aim() is aim
    here = it.motion.coordinates()
    assert it.motion.move(here, still, still) is here
    there = [*here[:3], 0.0, 0.0, 0.1]
    assert it.motion.move(there, still, still) == here
    assert it.motion.aim()[5] == pytest.approx(aim[5] - 0.1)
    assert it.motion.aim() is not aim


def test_numbers_of_too_few_axes_are_refused():
    it = Moved()

    with pytest.raises(ValueError, match="unpack"):
        it.motion.move([0.0] * 5, [0.0] * 6, [0.0] * 6)
    with pytest.raises(ValueError, match="unpack"):
        it.motion.take_rates([0.0] * 6, [0.0] * 5)


@needs_both
@settings(max_examples=100)
@given(
    st.tuples(arrays(16), arrays(16), arrays(6), arrays(6), arrays(6)),
    st.lists(limits, min_size=6, max_size=6),
    numbers,
)
def test_both_modes_agree_bit_for_bit(given_arrays, bounds, other):
    pose, target, way, velocities, a = given_arrays

    def scenario(module):
        it = Moved(module.PoseMotion, pose, target, *zip(*bounds, strict=True))
        found = [*it.motion.aim(), *it.motion.coordinates()]
        found += [*it.motion.move(way, velocities, a), *it.pose, *it.accelerations]
        it.motion.brake()
        found += [*it.motion.resting]
        found += [it.motion.is_at_rest(), it.motion.stays_within_speed()]
        it.motion.undo(a, [other] * 6)
        return [*found, *it.pose, *it.twist, *it.accelerations]

    assert_same("cartesian_motion_generator", scenario)
