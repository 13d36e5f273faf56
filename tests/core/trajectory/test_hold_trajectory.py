"""Holding and coming to rest."""

import pytest

from station.core.ports.goal import Goal
from station.core.trajectory import hold_trajectory, sample_segments, stop_trajectory


@pytest.mark.parametrize("time", [4.0, 5.0, 5.5, 100.0])
def test_holding_is_being_there_at_rest(time):
    trajectory = hold_trajectory(5.0, [0.3, -1.0])
    assert [sample_segments(joint, time) for joint in trajectory] == [
        (0.3, 0.0, 0.0),
        (-1.0, 0.0, 0.0),
    ]


def test_stopping_begins_with_the_motion_and_ends_at_rest():
    (joint,) = stop_trajectory(5.0, 0.5, [(0.3, 2.0)])
    assert sample_segments(joint, 5.0) == (0.3, 2.0, 0.0)
    # There and back in 1 s by symmetry: the turning point of the quintic spline lies
    # 5/16 of velocity times the whole time away.
    rest = sample_segments(joint, 5.5)
    assert rest[0] == pytest.approx(0.3 + 5 / 16 * 2.0 * 1.0)
    assert rest[1] == pytest.approx(0.0, abs=1e-12)
    assert sample_segments(joint, 6.0)[1:] == (0.0, 0.0)


def test_stopping_never_reverses():
    (joint,) = stop_trajectory(0.0, 0.5, [(0.0, -1.5)])
    velocities = [sample_segments(joint, 0.01 * step)[1] for step in range(51)]
    assert all(velocity <= 1e-12 for velocity in velocities)


def test_a_goal_can_wait_for_it():
    goal = Goal("1", {})
    assert hold_trajectory(0.0, [0.0], goal)[0][0].goal is goal
    assert stop_trajectory(0.0, 1.0, [(0.0, 1.0)], goal)[0][0].goal is goal
