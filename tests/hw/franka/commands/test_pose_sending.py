"""Poses that are passed on in usual cycles, and both modes of the kernel."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.hw.franka.commands.pose_sending import PassedPoses
from station.memory.doubles import doubles
from tests.both_modes import arrays, assert_same, needs_both

NO_ELBOW = doubles([0.0, 0.0])


def pose(x):
    return doubles([float(x + i) for i in range(16)])


def passed():
    """Return what has passed on a pose in each of four cycles."""
    found = PassedPoses()
    for cycle in range(4):
        found.cycle = cycle
        found.note(pose(cycle), NO_ELBOW)
    return found


def test_the_last_three_poses_are_kept():
    found = passed()

    kept = {place: found.poses[16 * place] for place in range(3)}
    assert [kept[(found.newest - age) % 3] for age in range(3)] == [3.0, 2.0, 1.0]
    cycles = (found.last_cycle, found.earlier_cycle, found.before_cycle)
    assert cycles == (3, 2, 1)


def test_a_pose_of_the_next_cycle_is_usual():
    found = passed()

    assert found.pass_usual(pose(9), NO_ELBOW)
    assert (found.cycle, found.last_cycle) == (4, 4)
    assert found.repeats(pose(9))
    assert not found.repeats(pose(3))


@pytest.mark.parametrize("what", ["gap", "offset"])
def test_a_pose_after_a_gap_is_not(what):
    found = passed()
    if what == "gap":
        found.cycle += 1
    else:
        found.is_on_commands = False
    before = [found.cycle, found.last_cycle, *found.poses]

    assert not found.pass_usual(pose(9), NO_ELBOW)
    assert before == [found.cycle, found.last_cycle, *found.poses]


@needs_both
@given(st.lists(st.tuples(arrays(16), arrays(2), st.integers(1, 2)), max_size=6))
def test_both_modes_agree_bit_for_bit(commands):
    def scenario(module):
        found, results = module.PassedPoses(), []
        for values, elbow, gap in commands:
            found.cycle += gap - 1
            if not found.pass_usual(doubles(values), doubles(elbow)):
                found.cycle += 1
                found.note(doubles(values), doubles(elbow))
            results += [found.repeats(doubles(values)), found.newest]
            results += [*found.poses, *found.elbows, found.before_cycle]
        return [float(value) for value in results]

    assert_same("pose_sending", scenario)
