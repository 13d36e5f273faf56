"""The sets of a robot's resources that a controller of the storm can claim."""

from typing import NamedTuple

from station.core.errors import StationError
from station.core.hardware.robot_hw import ControllerInfo, InterfaceResources, RobotHW
from station.testing.switch_observer import command_places


class Claim(NamedTuple):
    """The claim of a controller of the storm.

    Attributes:
        interface: Wire name of the hardware interface.
        resources: Names of the resources.
    """

    interface: str
    resources: tuple[str, ...]


def find_claims(robot: RobotHW) -> list[Claim]:
    """Return the claims that the robot accepts: single resources, and whole interfaces.

    Args:
        robot: The robot, initialised. Nothing is switched; it is only asked.
    """
    by_interface: dict[str, list[str]] = {}
    for place in command_places(robot):
        interface, resource = place.claim
        names = by_interface.setdefault(interface, [])
        if resource not in names:
            names.append(resource)
    return [
        claim
        for interface, names in by_interface.items()
        for claim in dict.fromkeys((
            *(Claim(interface, (name,)) for name in names),
            *_prefixed(interface, names),
            Claim(interface, tuple(names)),
        ))
        if _accepts(robot, claim)
    ]


def _prefixed(interface: str, names: list[str]) -> list[Claim]:
    """Return one claim per arm, whose joints have the same name before `_joint`."""
    prefixes = dict.fromkeys(name.partition("_joint")[0] for name in names)
    return [
        Claim(interface, tuple(n for n in names if n.startswith(f"{prefix}_joint")))
        for prefix in prefixes
        if any(name.startswith(f"{prefix}_joint") for name in names)
    ]


def _accepts(robot: RobotHW, claim: Claim) -> bool:
    info = ControllerInfo("storm", "storm/Controller", (InterfaceResources(*claim),))
    try:
        if robot.check_for_conflict([info]):
            return False
        robot.prepare_switch([info], [])
    except StationError:
        return False
    return True
