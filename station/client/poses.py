"""Poses that an arm can be told to move to."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from station.client.errors import ApiError

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


Target: TypeAlias = str | Sequence[float] | Mapping[str, float]
"""Where joints are to go: a named pose, one position per joint, or some by joint."""


@dataclass(frozen=True, slots=True)
class Pose:
    """A pose of an arm's end effector EE in the arm's base frame O.

    Attributes:
        position: Position of EE's origin, x, y, z [m].
        orientation: Unit quaternion x, y, z, w of EE; None keeps the present one.
    """

    position: tuple[float, float, float]
    orientation: tuple[float, float, float, float] | None = None


class UnknownPoseError(ApiError, ValueError):
    """There is no pose of that name, or not of these joints."""

    def __init__(self, detail: str, remedy: str) -> None:
        super().__init__(detail, status=0, code="unknown_pose", remedy=remedy)


def check_name(pose: str) -> None:
    """Refuse the name of a pose that does not exist.

    Raises:
        UnknownPoseError: There is no such pose.
    """
    if pose not in POSES:
        raise UnknownPoseError(
            f"There is no pose '{pose}'. The poses are: {', '.join(sorted(POSES))}.",
            "Name one of them, or give one number per joint.",
        )


def positions_of(pose: str, joints: Sequence[str]) -> list[float]:
    """Return a named pose of some joints [rad].

    Args:
        pose: Its name, see `check_name`.
        joints: The joints.

    Raises:
        UnknownPoseError: The pose is one of other joints.
    """
    known = POSES[pose]
    ends = [re.sub(r"^.*_(?=joint\d+$)", "", name) for name in joints]
    if sorted(ends) != sorted(known):
        raise UnknownPoseError(
            f"The pose '{pose}' is one of the 7 joints of a Franka arm; the controller "
            f"moves {', '.join(joints)}.",
            "Give one number per joint instead.",
        )
    return [known[end] for end in ends]
