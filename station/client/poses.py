"""Targets of a motion: named poses, positions of joints, and their goals."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from pydantic import JsonValue

from station.client.errors import ApiError, MotionError

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
"""Joint positions [rad] of Franka arms, by the ending of the joint's name.

A simulated arm and the examples of franka_ros begin at `ready`.
"""


Target: TypeAlias = str | Sequence[float] | Mapping[str, float]
"""Target of joints: a named pose, one position per joint, or positions by joint."""


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
    """There is no pose of that name, or it has other joints."""

    def __init__(self, detail: str, remedy: str) -> None:
        super().__init__(detail, status=0, code="unknown_pose", remedy=remedy)


def check_name(pose: str) -> None:
    """Refuse an unknown name of a pose.

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
        UnknownPoseError: The pose has other joints.
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


CALM_SPEED = 0.5
"""Mean speed of the joint that moves farthest, if no duration is given [rad/s]."""
SHORTEST = 1.0
"""Shortest duration of a motion, if none is given [s]."""


def joint_positions(
    target: Target, names: Sequence[str], here: Sequence[float | None]
) -> list[float]:
    """Return one position per joint [rad or m], shape (n,).

    Args:
        target: Target of the joints.
        names: The joints.
        here: Present set-points, shape (n,); joints without a target keep theirs.

    Raises:
        UnknownPoseError: There is no pose of that name for these joints.
        MotionError: The number of positions or the name of a joint is wrong.
    """
    if isinstance(target, str):
        return positions_of(target, names)
    if isinstance(target, Mapping):
        unknown = sorted(set(target) - set(names))
        if unknown:
            raise MotionError(
                f"There is no joint '{unknown[0]}'. The joints are: {', '.join(names)}."
            )
        return [
            target.get(name, position or 0.0)
            for name, position in zip(names, here, strict=True)
        ]
    if len(target) != len(names):
        raise MotionError(
            f"{len(target)} positions were given for {len(names)} joints: "
            f"{', '.join(names)}."
        )
    return list(target)


def trajectory_goal(
    names: Sequence[str],
    here: Sequence[float | None],
    values: Sequence[float],
    duration: float | None,
) -> Mapping[str, JsonValue]:
    """Return a FollowJointTrajectoryGoal that ends at rest.

    Args:
        names: The joints.
        here: Present set-points [rad or m], shape (n,).
        values: Target positions [rad or m], shape (n,).
        duration: Duration of the motion [s]; None for a slow motion.
    """
    ways = [abs(v - (h or 0.0)) for v, h in zip(values, here, strict=True)]
    calm = max(SHORTEST, max(ways, default=0.0) / CALM_SPEED)
    point: dict[str, JsonValue] = {
        "positions": list(values),
        "velocities": [0.0] * len(values),
        "accelerations": [0.0] * len(values),
        "time_from_start": calm if duration is None else duration,
    }
    return {"trajectory": {"joint_names": list(names), "points": [point]}}
