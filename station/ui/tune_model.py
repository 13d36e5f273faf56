"""The controllers and groups of gains that the Tune panel offers."""

from collections.abc import Iterable

from station.ui.station_view import StationView

GENERAL = "general"
"""Name of the group of gains that belong to no joint."""


def tunable_controllers(view: StationView) -> list[str]:
    """Return the controllers that claim a resource, the running controllers first."""
    names = [
        c.name
        for c in view.controllers
        if any(claim.resources for claim in c.claimed_resources)
    ]
    running = {c.name for c in view.controllers if c.state == "running"}
    return sorted(names, key=lambda name: (name not in running, name))


def gain_groups(names: Iterable[str]) -> dict[str, list[str]]:
    """Group gains by the joint to which they belong.

    Args:
        names: Names of gains, e.g. `panda_joint1/p`.

    Returns:
        The gains by the name of the joint, in the order given; gains without a joint
        are under `GENERAL`.
    """
    groups: dict[str, list[str]] = {}
    for name in names:
        group = name.rpartition("/")[0] or GENERAL
        groups.setdefault(group, []).append(name)
    return groups


def gain_label(name: str, unit: str) -> str:
    """Return a slider's label: the gain's own name and its unit."""
    short = name.rpartition("/")[2].replace("_", " ")
    return f"{short} [{unit}]" if unit else short


def series_index(names: list[str], group: str) -> int | None:
    """Return the index of the sample's element that a group of gains belongs to."""
    for i, name in enumerate(names):
        if group in {name, f"gains/{name}"} or group.startswith(f"{name}/"):
            return i
    return 0 if names and group == GENERAL else None
