"""Every motion of a designed spring and damper has the damping ratio."""

import numpy as np
import pytest

from station.controllers.impedance_controllers import (
    damping_matrix,
)


@pytest.mark.parametrize("ratio", [0.3, 0.7, 1.0])
def test_every_mode_has_the_damping_ratio(ratio):
    rng = np.random.default_rng(1)
    half = rng.normal(size=(6, 6))
    inertia = half @ half.T + np.eye(6)
    stiffness = [3000.0, 10.0, 400.0, 1.0, 30.0, 300.0]
    damping = damping_matrix(inertia, stiffness, ratio)

    # The poles of M ddx + D dx + K x = 0, which the design does not compute.
    inverse = np.linalg.inv(inertia)
    system = np.block([
        [np.zeros((6, 6)), np.eye(6)],
        [-inverse @ np.diag(stiffness), -inverse @ damping],
    ])
    poles = np.linalg.eigvals(system)
    # Critical poles are double, which rounding tells apart by the root of an epsilon.
    assert -poles.real / np.abs(poles) == pytest.approx(np.full(12, ratio), abs=1e-5)


def test_without_stiffness_there_is_no_damping():
    damping = damping_matrix(np.diag([1.0, 2.0]), [0.0, 8.0], 0.5)

    assert damping == pytest.approx(np.diag([0.0, 4.0]))
