"""Give the links that move an inertia that some rigid body can have.

Source: MuJoCo documentation, XML reference, compiler/balanceinertia: where the
principal moments violate A + B >= C, all three become their mean. MuJoCo refuses links
without mass; here they get a small one, `SMALL_MASS`.
"""

from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from station.core.description.repair import Repair
from station.core.description.urdf import Inertial, Link, Pose, Urdf
from station.hw.mujoco.inertia import carried_inertials, combine, principal_moments

SMALL_MASS = 1e-3
"""Mass of a moving link without one [kg]."""
_RADIUS = 0.01
_SMALL_MOMENT = 0.4 * SMALL_MASS * _RADIUS**2
"""Moment of inertia of a ball of that mass, with a radius of 1 cm [kg m^2]."""
# MuJoCo's smallest mass and inertia of a body that moves, mjMINVAL.
_LEAST = 1e-15


def repair_inertias(urdf: Urdf) -> tuple[Urdf, tuple[Repair, ...]]:
    """Return the robot with links that can move, and the changes.

    Args:
        urdf: The robot; the same is returned when there is nothing to repair.
    """
    changed: dict[str, Link] = {}
    repairs: list[Repair] = []
    for joint in urdf.joints.values():
        if not joint.type.moves:
            continue
        link = urdf.links[joint.child]
        parts = carried_inertials(urdf, link)
        if not parts:
            if not _has_body_below(urdf, link.name):
                changed[link.name] = replace(link, inertial=_small_ball())
                repairs.append(_tell_mass(link))
            continue
        whole = combine(list(parts.values()))
        moments = principal_moments(whole)
        if moments[0] > _LEAST and moments[0] + moments[1] >= moments[2]:
            continue
        balanced, repair = _balance(link, whole, moments)
        # It has the masses of the others now.
        changed |= {n: replace(urdf.links[n], inertial=None) for n in parts}
        changed[link.name] = replace(link, inertial=balanced)
        repairs.append(repair)
    if not changed:
        return urdf, ()
    links = MappingProxyType({**urdf.links, **changed})
    return (
        Urdf(urdf.name, links, urdf.joints, urdf.root),
        tuple(repairs),
    )


def _balance(
    link: Link, whole: Inertial, moments: NDArray[np.float64]
) -> tuple[Inertial, Repair]:
    """Return equal moments in place of all that a link carries."""
    mean = float(np.mean(moments))
    if mean > _LEAST:
        problem = "no rigid body has its principal moments of inertia"
    else:
        mean = max(0.4 * whole.mass * _RADIUS**2, _SMALL_MOMENT)
        problem = "it moves and has no inertia"
    own = 0.0 if link.inertial is None else link.inertial.mass
    others = whole.mass - own
    old = " ".join(f"{moment:.4g}" for moment in moments.tolist())
    new = f"{mean:.4g} about every axis [kg m^2]"
    if others > 0.0:
        new += f", with {others:.4g} kg fixed to it"
    balanced = Inertial(whole.mass, whole.origin, (mean, mean, mean, 0.0, 0.0, 0.0))
    return balanced, Repair("inertia", f"link '{link.name}'", problem, old, new)


def _small_ball() -> Inertial:
    moment = _SMALL_MOMENT
    return Inertial(SMALL_MASS, Pose(), (moment, moment, moment, 0.0, 0.0, 0.0))


def _tell_mass(link: Link) -> Repair:
    new = f"{SMALL_MASS:g} kg and {_SMALL_MOMENT:.1g} kg m^2"
    return Repair("mass", f"link '{link.name}'", "it moves and has no mass", "0", new)


def _has_body_below(urdf: Urdf, link: str) -> bool:
    """Return whether a body with mass is fixed to a link without one."""
    frontier = [link]
    while frontier:
        name = frontier.pop()
        for joint in urdf.joints_below(name):
            if not joint.type.moves:
                if urdf.links[joint.child].inertial is not None:
                    return True
                frontier.append(joint.child)
    return False
