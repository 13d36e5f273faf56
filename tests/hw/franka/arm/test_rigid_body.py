"""End effector and load as one body."""

import numpy as np
import pytest

from station.hw.franka.arm.rigid_body import RigidBody, combine_bodies


def test_centre_of_mass_is_that_of_libfrankas_test() -> None:
    total = combine_bodies(
        RigidBody(0.73, (-0.01, 0.0, -0.03)), RigidBody(0.5, (0.01, -0.2, 0.03))
    )
    expected = (-0.0018699, -0.0813008, -0.0056098)
    assert total.mass == pytest.approx(1.23)
    assert total.center_of_mass == pytest.approx(expected, abs=5e-8)


def test_inertia_is_that_of_two_points_about_their_centre() -> None:
    ends = combine_bodies(
        RigidBody(1.0, (0.0, 0.0, 1.0)), RigidBody(1.0, (0.0, 0.0, -1.0))
    )
    assert ends.center_of_mass == (0.0, 0.0, 0.0)
    expected = np.diag([2.0, 2.0, 0.0]).ravel()
    assert ends.inertia == pytest.approx(expected.tolist())


def test_inertia_of_no_mass_does_not_count() -> None:
    body = RigidBody(
        2.0, (0.1, 0.2, 0.3), (1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 3.0)
    )
    ghost = RigidBody(0.0, (9.0, 9.0, 9.0), (5.0,) * 9)
    total = combine_bodies(body, ghost)
    assert total.center_of_mass == pytest.approx(body.center_of_mass)
    assert total.inertia == pytest.approx(body.inertia)


def test_two_empty_loads_combine_to_an_empty_load() -> None:
    assert combine_bodies(RigidBody(), RigidBody()) == RigidBody()
