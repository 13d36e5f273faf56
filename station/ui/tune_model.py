"""Which gains the Tune panel shows, grouped the way people think of them."""

from collections.abc import Iterable

from station.ui.station_view import StationView

GENERAL = "general"
"""Group of the gains that belong to no joint."""


def tunable_controllers(view: StationView) -> list[str]:
    """Return the controllers that command something, running ones first."""
    names = [
        c.name
        for c in view.controllers
        if any(claim.resources for claim in c.claimed_resources)
    ]
    running = {c.name for c in view.controllers if c.state == "running"}
    return sorted(names, key=lambda name: (name not in running, name))


def gain_groups(names: Iterable[str]) -> dict[str, list[str]]:
    """Group gains by what they belong to.

    Args:
        names: Names of gains, e.g. `panda_joint1/p`.

    Returns:
        The gains of each joint by its name, in the order given; those without a
        joint under `GENERAL`.
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
    """Return which element of a controller's sample belongs to a group of gains."""
    for i, name in enumerate(names):
        if group in {name, f"gains/{name}"} or group.startswith(f"{name}/"):
            return i
    return 0 if names and group == GENERAL else None
