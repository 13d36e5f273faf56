"""Clearances of an arm that moves, against those of one that measures all anew."""

import numpy as np
import pytest

from station.core.description.urdf import Pose
from station.core.geometry.clearances import Clearances
from station.core.geometry.scene import SceneObject, solid_of
from station.memory.doubles import doubles
from tests.both_modes import assert_same, needs_both

# Three joints, about z, y and y, with links of 0.4 m.
CHAIN = [
    0.0, 0.3, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.4, 0.0, 1.0, 0.0, 0.4, 0.0, 1.0, 0.0
]  # fmt: skip
# Of unlike radii: at a joint two pairs would be equally near.
CAPSULES = [
    *(0.0, 0.0, -0.3, 0.0, 0.0, 0.0, 0.06),
    *(0.0, 0.0, 0.0, 0.4, 0.0, 0.0, 0.05),
    *(0.0, 0.0, 0.0, 0.4, 0.0, 0.0, 0.04),
]
SCENE = [
    SceneObject("ball", "sphere", (0.1,), (0.7, 0.2, 0.4), role="keep_out"),
    SceneObject("table", "box", (0.5, 0.8, 0.1), (0.6, 0.0, -0.1), role="keep_out"),
    SceneObject("post", "cylinder", (0.1, 1.0), (-0.5, 0.4, 0.5), role="keep_out"),
    SceneObject("cell", "box", (2.0, 2.0, 2.4), role="fence"),
]
OTHER, HORIZON = len(SCENE), 0.1
PLACE = doubles([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])


def make(kind=Clearances) -> Clearances:
    solids = [number for one in SCENE for number in solid_of(one, Pose(), [])]
    clearances = kind(doubles(CHAIN), CAPSULES, [0, 1, 2])
    clearances.set_solids([*solids, *([0.0] * 20)], [])
    clearances.allow(1, [False, True, True])
    return clearances


def moving(seed: int, cycles: int):
    """Yield poses, and the ends of a capsule that moves, too."""
    random = np.random.default_rng(seed)
    q, rate = random.uniform(-1.0, 1.0, 3), random.uniform(-2.0, 2.0, 3)
    for cycle in range(cycles):
        if cycle % 100 == 99:
            q = random.uniform(-1.0, 1.0, 3)  # a jump
        q = q + 0.005 * rate * np.sin(0.01 * cycle)
        x, z = 1.0 + 0.5 * np.sin(0.03 * cycle), 0.4 * np.cos(0.02 * cycle)
        yield doubles(q), doubles([x, 0.1, z, x + 0.3 * z, 0.3, 0.2])


@pytest.mark.parametrize("seed", range(6))
def test_pairs_that_are_passed_over_change_nothing(seed):
    kept = make()
    for q, ends in moving(seed, 300):
        anew = make()
        for one in (kept, anew):
            one.put_capsule(OTHER, PLACE, ends, 0.05, 0.02)
        assert kept.measure(q, HORIZON) == anew.measure(q, HORIZON)
        assert kept.pair == anew.pair
        # A gap and a margin add up to the distance but for rounding.
        assert kept.distance == pytest.approx(anew.distance, abs=1e-12)
        for mine, full in zip(kept.gaps, anew.gaps, strict=True):
            assert mine == full or min(mine, full) > HORIZON


@needs_both
def test_both_modes_agree_bit_for_bit():
    def scenario(module):
        clearances, found = make(module.Clearances), []
        for q, ends in moving(1, 150):
            clearances.put_capsule(OTHER, PLACE, ends, 0.05, 0.02)
            for i in range(3):
                clearances.way[i] = 0.2 * ends[i]
            found += [clearances.free_share(q, 0.01), clearances.distance]
            found += [float(clearances.pair), float(clearances.blocking)]
        return found

    assert_same("clearances", scenario)
