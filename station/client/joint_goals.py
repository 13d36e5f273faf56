"""Goals of a trajectory controller, from what a person says."""

from collections.abc import Mapping, Sequence

from pydantic import JsonValue

from station.client.errors import MotionError
from station.client.poses import Target, positions_of

CALM_SPEED = 0.5
"""Mean speed of the joint that has the longest way, without a duration [rad/s]."""
SHORTEST = 1.0
"""Shortest time that is chosen without a duration [s]."""


def joint_positions(
    target: Target, names: Sequence[str], here: Sequence[float | None]
) -> list[float]:
    """Return one position per joint [rad or m], shape (n,).

    Args:
        target: Where the joints are to go.
        names: The joints.
        here: Where they are wanted now, shape (n,); they stay there unless named.

    Raises:
        UnknownPoseError: There is no such pose of these joints.
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
        here: Where they are wanted now [rad or m], shape (n,).
        values: Where they are to go [rad or m], shape (n,).
        duration: How long it takes [s]; a calm time when None.
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
