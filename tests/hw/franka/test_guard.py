"""The guard under all kinds of command; MuJoCo and Coal judge how near arms come."""

import pytest

from station.compiled import status
from tests.hw.franka.guarded_motions import (
    ARM_MARGIN,
    KINDS,
    TOLERANCE,
    Motions,
    TwoArms,
    check,
)

compiled_alone = pytest.mark.skipif(
    not status().is_compiled,
    reason="minutes, interpreted; test_guard.py of core is not",
)


@pytest.fixture(scope="module")
def motions() -> Motions:
    return Motions()


@compiled_alone
@pytest.mark.parametrize("kind", KINDS)
def test_no_motion_comes_nearer_than_its_margin(motions, kind):
    near, free = check(motions, [kind], range(4), every=100)
    assert near + free >= 2


@pytest.mark.slow
@compiled_alone
@pytest.mark.parametrize("kind", KINDS)
def test_more_motions_keep_their_margin_by_two_judges(motions, kind):
    check(motions, [kind], range(4, 20), every=10)


@compiled_alone
@pytest.mark.parametrize("seed", [1, 4])
def test_two_arms_that_swing_at_each_other_keep_their_margin(seed):
    arms = TwoArms()
    assert arms.swing(seed, guarded=False) < ARM_MARGIN
    assert arms.swing(seed, guarded=True) >= ARM_MARGIN - TOLERANCE
