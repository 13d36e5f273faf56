"""The arm's load: end effector and payload as one rigid body at the flange.

Source: libfranka@0.9.2 src/load_calculations.cpp, combineCenterOfMass,
combineInertiaTensor.
"""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RigidBody:
    """A rigid body fixed to the flange.

    Attributes:
        mass: Mass [kg], >= 0.
        center_of_mass: Centre of mass in the flange frame [m], shape (3,).
        inertia: Inertia about the centre of mass, axes of the flange [kg m^2], 3 x 3,
            flat.
    """

    mass: float = 0.0
    center_of_mass: tuple[float, ...] = (0.0, 0.0, 0.0)
    inertia: tuple[float, ...] = (0.0,) * 9


def combine_bodies(first: RigidBody, second: RigidBody) -> RigidBody:
    """Return two bodies at the flange as one; a body without mass adds no inertia."""
    mass = first.mass + second.mass
    if mass == 0.0:
        return RigidBody()
    center = [
        (first.mass * a + second.mass * b) / mass
        for a, b in zip(first.center_of_mass, second.center_of_mass, strict=True)
    ]
    total = [-value for value in _steiner(mass, center)]
    for part in (first, second):
        if part.mass == 0.0:
            continue
        moved = _steiner(part.mass, part.center_of_mass)
        total = [
            t + own + extra
            for t, own, extra in zip(total, part.inertia, moved, strict=True)
        ]
    return RigidBody(mass, tuple(center), tuple(total))


def _steiner(mass: float, offset: Sequence[float]) -> list[float]:
    """Return mass * (|offset|^2 I - offset offset^T), flat, shape (9,)."""
    squared = sum(value * value for value in offset)
    return [
        mass * ((squared if row == column else 0.0) - offset[row] * offset[column])
        for column in range(3)
        for row in range(3)
    ]
