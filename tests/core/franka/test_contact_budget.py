"""The contact budget against a contact computed step by step."""

import numpy as np
import pytest

from station.core.franka.franka_services import REGIONS, contact_budget


def slider(mass: float) -> tuple[list[float], list[float]]:
    """Return mass matrix and Jacobian of a cart on three rails."""
    jacobian = np.zeros((6, 3))
    jacobian[:3] = np.eye(3)
    return [*(mass * np.eye(3)).ravel()], [*jacobian.T.ravel()]


@pytest.mark.parametrize("region", sorted(REGIONS))
def test_the_permitted_speed_leads_to_the_permitted_force(region):
    mass, jacobian = slider(4.0)
    found = contact_budget(mass, jacobian, [0.3, 0.0, 0.4])
    assert found["effective_mass"] == pytest.approx(4.0)
    assert found["direction"] == pytest.approx([0.6, 0.0, 0.8])
    assert found["speed"] == pytest.approx(0.5)
    body, budget = REGIONS[region], found["regions"][region]

    # Two masses and a spring between them, in small steps.
    dt, squeeze, robot, person, force, most = 1e-6, 0.0, budget["speed"], 0.0, 0.0, 0.0
    while squeeze >= 0.0 and robot > person - 1e-12:
        force = body.stiffness * squeeze
        robot -= force / 4.0 * dt
        person += force / body.mass * dt
        squeeze += (robot - person) * dt
        most = max(most, force)

    assert most == pytest.approx(body.force, rel=1e-3)
    assert budget["energy"] == pytest.approx(most**2 / (2 * body.stiffness), rel=2e-3)


def test_at_rest_the_direction_is_that_of_the_largest_mass():
    mass, jacobian = slider(1.0)
    mass[4] = 7.0
    found = contact_budget(mass, jacobian, [0.0, 0.0, 0.0])
    assert found["effective_mass"] == pytest.approx(7.0)
    assert [abs(one) for one in found["direction"]] == pytest.approx([0.0, 1.0, 0.0])
