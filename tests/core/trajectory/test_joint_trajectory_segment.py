"""Finding and sampling segments; whole turns; bridges that begin later."""

from math import inf, pi

import pytest

from station.core.ports.goal import Goal
from station.core.trajectory import (
    JointTrajectorySegment,
    PosVelAccState,
    QuinticSplineSegment,
    find_segment,
    sample_segments,
    wraparound_offset,
)


def _line(start_time, start, end_time, end):
    states = PosVelAccState([start]), PosVelAccState([end])
    spline = QuinticSplineSegment(start_time, states[0], end_time, states[1])
    return JointTrajectorySegment(spline, states[1])


SEGMENTS = [_line(1.0, 0.0, 2.0, 1.0), _line(2.0, 1.0, 4.0, 0.0)]


@pytest.mark.parametrize(
    ("time", "index"),
    [(-inf, None), (0.999, None), (1.0, 0), (1.999, 0), (2.0, 1), (4.0, 1), (inf, 1)],
)
def test_a_segment_is_active_from_its_start_on(time, index):
    assert find_segment(SEGMENTS, time) == index


def test_nothing_is_active_in_an_empty_list():
    assert find_segment([], 0.0) is None


@pytest.mark.parametrize(
    ("time", "state"),
    [
        (0.0, (0.0, 0.0, 0.0)),
        (1.5, (0.5, 1.0, 0.0)),
        (3.0, (0.5, -0.5, 0.0)),
        (9.0, (0.0, 0.0, 0.0)),
    ],
)
def test_outside_of_the_segments_the_joint_rests(time, state):
    assert sample_segments(SEGMENTS, time) == state


def test_offsets_are_those_of_the_original(vectors):
    assert len(vectors["wraparound_offset"]) >= 50
    for case in vectors["wraparound_offset"]:
        if case["wrap"]:
            assert wraparound_offset(case["prev"], case["next"]) == pytest.approx(
                case["offset"], abs=1e-12
            )


@pytest.mark.parametrize(
    ("previous", "following", "turns"),
    [(0.0, 2 * pi, -1), (0.0, pi, 0), (pi, 0.0, 0), (3.0, -3.0, 1), (7.0, 1.0, 1)],
)
def test_the_offset_is_whole_turns(previous, following, turns):
    offset = wraparound_offset(previous, following)
    assert offset == pytest.approx(turns * 2 * pi, abs=1e-9)


def test_a_segment_can_change_its_goal():
    goal = Goal("1", {})
    changed = SEGMENTS[0].with_goal(goal)
    assert changed.goal is goal
    assert changed.spline is SEGMENTS[0].spline
    assert SEGMENTS[0].goal is None


def test_a_segment_that_begins_later_has_the_same_end():
    later = SEGMENTS[0].starting_at(1.5, PosVelAccState([0.2], [0.0], [0.0]))
    assert sample_segments([later], 1.5)[0] == 0.2
    assert sample_segments([later], 2.0)[0] == pytest.approx(1.0)
    assert (later.start_time, later.end_time) == (1.5, 2.0)
