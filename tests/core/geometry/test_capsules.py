"""Capsules that enclose a link."""

import numpy as np
import pytest

from station.core.geometry.capsules import enclose


@pytest.mark.parametrize("seed", range(6))
def test_capsules_enclose_every_point_of_the_hull(seed):
    random = np.random.default_rng(seed)
    # Two lumps, so that one capsule would be far too thick.
    vertices = np.vstack([
        random.normal(size=(40, 3)) * [0.02, 0.03, 0.1],
        random.normal(size=(40, 3)) * [0.05, 0.02, 0.02] + [0.1, 0.0, 0.2],
    ])
    shares = random.dirichlet(np.ones(len(vertices)) * 0.1, size=2000)
    points = np.vstack([shares @ vertices, vertices])
    outside = np.full(len(points), np.inf)
    for one in enclose("link", vertices):
        first, axis = np.array(one.first), np.subtract(one.second, one.first)
        share = np.clip((points - first) @ axis / max(axis @ axis, 1e-12), 0, 1)
        gaps = np.linalg.norm(points - first - share[:, None] * axis, axis=1)
        outside = np.minimum(outside, gaps - one.radius)

    assert outside.max() <= 1e-9
