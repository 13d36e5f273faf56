"""Estimate the speed at which a contact with a person would stay below a limit.

This is not a safety function: it stops nothing, it is not certified, and the masses of
a real arm, its tool and its load are not known exactly.

Source: ISO/TS 15066:2016, annex A: a contact of two masses through the spring of a body
region, F = v sqrt(mu k), with the reduced mass mu of both; differs: the mass of the
robot is the effective one along the direction, not half the mass of its moving parts.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

# Speed below which the motion has no direction [m/s].
_AT_REST = 1e-3


@dataclass(frozen=True, slots=True)
class BodyRegion:
    """A region of the human body.

    Attributes:
        force: Largest force of a transient contact [N].
        stiffness: Effective spring constant [N/m].
        mass: Effective mass [kg].
    """

    force: float
    stiffness: float
    mass: float


REGIONS = {
    "neck": BodyRegion(300.0, 50e3, 1.2),
    "back": BodyRegion(420.0, 35e3, 40.0),
    "chest": BodyRegion(280.0, 25e3, 40.0),
    "abdomen": BodyRegion(220.0, 10e3, 40.0),
    "pelvis": BodyRegion(360.0, 25e3, 40.0),
    "upper_arm": BodyRegion(300.0, 30e3, 3.0),
    "forearm": BodyRegion(320.0, 40e3, 2.0),
    "hand": BodyRegion(280.0, 75e3, 0.6),
    "thigh": BodyRegion(440.0, 50e3, 75.0),
    "shin": BodyRegion(260.0, 60e3, 75.0),
}
"""The body regions by name. Their forces are twice those of a quasi-static contact.
Skull and face have no permitted value.

Source: ISO/TS 15066:2016, tables A.2 and A.3, which are not public. The figures were
compared with published ones: springs and masses are those of
epfl-lasa/human-robot-collider, `collision.py`, for a person of 75 kg. Two further
programs have the same forces, except for the neck, for which one of them has 290 N. For
thigh and shin one program has masses of 8 and 4 kg; the 75 kg of the whole body, used
here, permit less speed.
"""


def contact_budget(
    mass: Sequence[float], jacobian: Sequence[float], dq: Sequence[float]
) -> dict[str, object]:
    """Return effective mass, speed, and the speed that each body region permits.

    Args:
        mass: Mass matrix [kg m^2], n n numbers.
        jacobian: Jacobian of the point of contact, 6 n numbers, column-major.
        dq: Joint velocities [rad/s], shape (n,).

    Returns:
        `direction`, the unit vector of the motion in the base frame, or at rest the
        direction of the largest effective mass; `effective_mass` along it [kg]; `speed`
        [m/s]; and for each body region the `speed` [m/s] up to which the force of a
        transient contact stays below `force` [N], and the `energy` [J] at this speed.
    """
    count = len(dq)
    j = np.array(jacobian, dtype=float).reshape(count, 6).T[:3]
    mobility = j @ np.linalg.solve(np.array(mass, dtype=float).reshape(count, -1), j.T)
    velocity = j @ np.array(dq, dtype=float)
    speed = float(np.linalg.norm(velocity))
    if speed > _AT_REST:
        direction = velocity / speed
    else:
        direction = np.linalg.eigh(mobility)[1][:, 0]
    effective = effective_mass(mobility, direction)
    regions = {
        name: _budget(effective, region) for name, region in sorted(REGIONS.items())
    }
    return {
        "direction": [float(one) for one in direction],
        "effective_mass": effective,
        "speed": speed,
        "regions": regions,
    }


def effective_mass(
    mobility: NDArray[np.float64], direction: NDArray[np.float64]
) -> float:
    """Return the mass that a push along a direction meets [kg].

    Args:
        mobility: J M^-1 J^T of the point [1/kg], shape (3, 3).
        direction: Unit vector, shape (3,).
    """
    return 1.0 / float(direction @ mobility @ direction)


def _budget(robot: float, region: BodyRegion) -> dict[str, float]:
    reduced = 1.0 / (1.0 / robot + 1.0 / region.mass)
    speed = region.force / float(np.sqrt(reduced * region.stiffness))
    energy = region.force**2 / (2.0 * region.stiffness)
    return {"speed": speed, "force": region.force, "energy": energy}
