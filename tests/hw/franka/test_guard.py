"""The guard under all kinds of command: MuJoCo judges how near the arm comes."""

import os

import pytest

from station.compiled import status
from station.core.franka.franka_robot_state import RobotMode
from tests.hw.franka.guarded_motions import KINDS, MARGIN, Motions

compiled_alone = pytest.mark.skipif(
    not status().is_compiled,
    reason="minutes, interpreted; test_guard.py of core is not",
)
# The pose is sampled every 10 ms, and MuJoCo's distances end within 1e-6 m.
_TOLERANCE = 1e-3
# Bare motions that come as near as that may be slowed: the capsules are thicker than
# the links, and the guard looks ahead of the motion.
_CLEAR = 0.13
MOTIONS = int(os.environ.get("GUARDED_MOTIONS", "20"))
"""How many of each kind there are, the quick ones among them."""


@pytest.fixture(scope="module")
def motions() -> Motions:
    return Motions()


def check(motions: Motions, kinds, seeds) -> tuple[int, int]:
    """Return how many motions came too near without the guard, and how many were free.

    Checks that none comes too near with it, and that free ones are the same bits.
    """
    near = free = 0
    for kind in kinds:
        for seed in seeds:
            bare = motions.run(kind, seed, guarded=False)
            guarded = motions.run(kind, seed, guarded=True)
            where = f"{kind} {seed}"
            assert guarded.closest >= MARGIN - _TOLERANCE, where
            # What the arm can follow is slowed, not ended; torques may end in a reflex.
            if kind != "torque" and bare.mode is RobotMode.MOVE:
                assert guarded.mode is RobotMode.MOVE, f"{where}: {guarded.refusal}"
            near += bare.closest < MARGIN
            if guarded.interventions == 0:
                free += 1
                assert guarded.q.tobytes() == bare.q.tobytes(), where
            elif bare.closest > _CLEAR:
                pytest.fail(f"{where} was slowed, {bare.closest:.3f} m away")
    return near, free


@compiled_alone
@pytest.mark.parametrize("kind", KINDS)
def test_no_motion_comes_nearer_than_its_margin(motions, kind):
    near, free = check(motions, [kind], range(4))
    assert near + free >= 2


@pytest.mark.slow
@compiled_alone
def test_many_motions_keep_their_margin(motions):
    near, free = check(motions, KINDS, range(4, MOTIONS))
    assert near >= 1.5 * (MOTIONS - 4)
    assert free >= MOTIONS - 4
