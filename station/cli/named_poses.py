"""Poses that have a name, and the controller that goes to them."""

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from station.cli.errors import UsageError

if TYPE_CHECKING:
    from station.client import StationClient

POSES: Mapping[str, Mapping[str, float]] = {
    "ready": {
        "joint1": 0.0,
        "joint2": -0.785398,
        "joint3": 0.0,
        "joint4": -2.356194,
        "joint5": 0.0,
        "joint6": 1.570796,
        "joint7": 0.785398,
    },
    "stretched": {
        "joint1": 0.0,
        "joint2": 0.0,
        "joint3": 0.0,
        "joint4": -0.5,
        "joint5": 0.0,
        "joint6": 1.6,
        "joint7": 0.785398,
    },
}
"""Joint positions [rad] of Franka arms by the end of the joints' names.

`ready` is where a simulated arm starts and where franka_ros' examples begin.
"""
_KIND = "/JointTrajectoryController"


def check_name(pose: str) -> None:
    """Refuse the name of a pose that does not exist.

    Raises:
        UsageError: There is no such pose.
    """
    if pose not in POSES:
        raise UsageError(
            f"There is no pose '{pose}'. The poses are: {', '.join(sorted(POSES))}.",
            remedy="Name one of them, or a controller and one number per joint.",
        )


def positions_of(pose: str, joints: Sequence[str]) -> list[float]:
    """Return a named pose of some joints [rad].

    Args:
        pose: Its name, see `check_name`.
        joints: The joints.

    Raises:
        UsageError: The pose is one of other joints.
    """
    known = POSES[pose]
    ends = [re.sub(r"^.*_(?=joint\d+$)", "", name) for name in joints]
    if sorted(ends) != sorted(known):
        raise UsageError(
            f"The pose '{pose}' is one of the 7 joints of a Franka arm; the controller "
            f"moves {', '.join(joints)}.",
            remedy="Give the controller and one number per joint instead.",
        )
    return [known[end] for end in ends]


def ready_controller(client: "StationClient") -> str:
    """Return a trajectory controller that runs; start one when none does.

    Args:
        client: The station. It refuses when another controller has the joints.

    Raises:
        UsageError: No trajectory controller is loaded.
    """
    found = [c for c in client.controllers() if c.type.endswith(_KIND)]
    for controller in found:
        if controller.state == "running":
            return controller.name
    if not found:
        raise UsageError(
            "No JointTrajectoryController is loaded, and no other goes to a pose.",
            remedy="Load one: `station load_controller NAME FILE`.",
        )
    # By positions the arm itself keeps to the way, whatever it carries.
    found.sort(key=lambda controller: not controller.type.startswith("position_"))
    client.switch_controllers(start=[found[0].name])
    return found[0].name
