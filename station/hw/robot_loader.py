"""Find a robot by its type: the table, installed packages, or any Python class.

`CombinedRobotHW` is several robots as one, found in the same way.
"""

import importlib
from importlib.metadata import entry_points

from station.core.errors import StationError
from station.core.hardware import combined_robot_hw
from station.core.hardware.robot_hw import RobotHW
from station.core.installation import missing_extra
from station.hw import HARDWARE

ENTRY_POINTS = "station.hw"


class RobotTypeError(StationError, LookupError):
    """A type of robot is unknown, or names something that is not a robot."""

    code = "robot_type"


def create_robot(robot_type: str) -> RobotHW:
    """Return a new robot of `robot_type`, not yet initialised.

    Args:
        robot_type: A key of `HARDWARE`, the name of an entry point of the group
            `station.hw`, or `module:Class`.

    Raises:
        MissingExtraError: An extra of this distribution is not installed.
        RobotTypeError: The type is unknown, cannot be imported, or is not a `RobotHW`.
    """
    return find_robot(robot_type)()


def find_robot(robot_type: str) -> type[RobotHW]:
    """Return the class of a type of robots; see `create_robot`.

    Args:
        robot_type: As for `create_robot`.

    Raises:
        MissingExtraError: An extra of this distribution is not installed.
        RobotTypeError: The type is unknown, cannot be imported, or is not a `RobotHW`.
    """
    known = dict(HARDWARE)
    if robot_type not in known:  # searching the installed packages takes long
        installed = entry_points(group=ENTRY_POINTS)
        known = {**{entry.name: entry.value for entry in installed}, **known}
    target = known.get(robot_type, robot_type)
    if ":" not in target:
        raise RobotTypeError(
            f"robot.type is '{robot_type}'; allowed are {', '.join(sorted(known))}, "
            "or module:Class.",
            remedy="Correct robot.type in the configuration.",
        )
    module, _, name = target.partition(":")
    try:
        found = getattr(importlib.import_module(module), name)
    except (ImportError, AttributeError) as error:
        missing = missing_extra(error) if isinstance(error, ImportError) else None
        if missing is not None:
            raise missing from error
        raise RobotTypeError(
            f"robot.type '{robot_type}': {target} cannot be imported: {error}.",
            remedy="Correct the name, or install what is missing.",
        ) from error
    if not (isinstance(found, type) and issubclass(found, RobotHW)):
        raise RobotTypeError(
            f"robot.type '{robot_type}': {target} is not a RobotHW.",
            remedy="Derive it from station.core.hardware.robot_hw.RobotHW.",
        )
    return found


class CombinedRobotHW(combined_robot_hw.CombinedRobotHW):
    """Type `combined_robot_hw/CombinedRobotHW` of the configuration."""

    def __init__(self) -> None:
        super().__init__(create_robot)
