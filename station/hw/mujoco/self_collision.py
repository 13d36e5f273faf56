"""The pairs of a robot's links that can never touch, and the reason."""

from collections.abc import Iterable, Sequence
from itertools import product

import mujoco

from station.core.description.repair import Repair
from station.core.description.urdf import Urdf

Pair = tuple[str, str]
_MOST_NAMED = 12


def rigid_neighbours(urdf: Urdf) -> list[Pair]:
    """Return the pairs of links that one joint alone separates.

    Links that are rigidly joined to a joint's parent are next to its child just as the
    parent is. Pairs that a joint joins directly are left out, because they never touch
    anyway, and so are links without collision shapes.

    Args:
        urdf: The robot.
    """
    groups: dict[str, list[str]] = {}
    for name, link in urdf.links.items():
        root, _ = urdf.fixed_root(name)
        members = groups.setdefault(root, [])
        if link.collisions:
            members.append(name)
    pairs: set[Pair] = set()
    direct = {_sorted(j.parent, j.child) for j in urdf.joints.values()}
    for joint in urdf.joints.values():
        if joint.type.moves:
            above, _ = urdf.fixed_root(joint.parent)
            below = groups.get(joint.child, [])
            pairs |= {_sorted(a, b) for a, b in product(groups[above], below)}
    return sorted(pairs - direct)


def touching_pairs(model: mujoco.MjModel, data: mujoco.MjData) -> list[Pair]:
    """Return the names of the bodies that touch now, without those of the world."""
    found: set[Pair] = set()
    for number in range(int(data.ncon)):
        contact = data.contact[number]
        bodies = [int(model.geom_bodyid[geom]) for geom in contact.geom]
        # An object is no part of the robot: its body has a joint of its own name.
        if 0 not in bodies:
            first, second = (model.body(body).name for body in bodies)
            found.add(_sorted(first, second))
    return sorted(found)


def tell_pairs(pairs: Sequence[Pair], why: str) -> list[Repair]:
    """Return one line for pairs that are excluded from self-collision.

    Args:
        pairs: Names of links.
        why: The reason, as a clause.
    """
    if not pairs:
        return []
    return [
        Repair(
            "self_collision",
            f"{len(pairs)} pair(s) of links",
            why,
            "",
            f"never touch: {_names(pairs)}",
        )
    ]


def tell_contacts(pairs: Sequence[Pair]) -> Repair:
    """Return one line for links that touch at the start, and push each other apart.

    Args:
        pairs: Names of links, at least one pair.
    """
    return Repair(
        "start_pose",
        f"{len(pairs)} pair(s) of links",
        f"they touch in the start pose: {_names(pairs)}",
        "",
        "left to push each other apart; self_collision: srdf excludes them",
    )


def _names(pairs: Iterable[Pair]) -> str:
    names = [f"{first} and {second}" for first, second in pairs]
    more = len(names) - _MOST_NAMED
    shown = ", ".join(names[:_MOST_NAMED])
    return f"{shown} and {more} more" if more > 0 else shown


def _sorted(first: str, second: str) -> Pair:
    return (first, second) if first <= second else (second, first)
