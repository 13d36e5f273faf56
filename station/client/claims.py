"""Which controllers are in the way of a motion."""

from collections.abc import Iterable, Mapping


def in_the_way(
    wanted: Iterable[str], running: Mapping[str, Iterable[str]]
) -> list[str]:
    """Return the running controllers that command the same joints.

    A Franka accepts torques beside a motion, so that a switch does not refuse both; but
    the torques then decide where the joints go. Its end effector is the resource
    `<arm>_robot`, which moves all joints `<arm>_joint…`.

    Args:
        wanted: Resources that the motion needs.
        running: Resources of each running controller, by its name.
    """
    needed = set(wanted)
    return [
        name
        for name, resources in running.items()
        if any(_is_same(one, other) for one in resources for other in needed)
    ]


def _is_same(one: str, other: str) -> bool:
    return one == other or _moves(one, other) or _moves(other, one)


def _moves(arm: str, joint: str) -> bool:
    return arm.endswith("_robot") and joint.startswith(
        f"{arm.removesuffix('_robot')}_joint"
    )
