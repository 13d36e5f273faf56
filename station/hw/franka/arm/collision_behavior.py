"""The thresholds of contact and collision: their defaults and their check."""

from dataclasses import dataclass

from station.core.franka.franka_services import CollisionBehavior

DEFAULT_COLLISION_BEHAVIOR = CollisionBehavior(
    *((20.0, 20.0, 18.0, 18.0, 16.0, 14.0, 12.0),) * 4,
    *((20.0, 20.0, 20.0, 25.0, 25.0, 25.0),) * 4,
)
"""Thresholds as franka_control configures them; contact and collision coincide."""
_TORQUES, _FORCES = 7, 6


@dataclass(frozen=True, slots=True)
class ThresholdProblem:
    """A threshold that cannot be used.

    Attributes:
        field: Name of the threshold in `CollisionBehavior`.
        allowed: What the threshold must be, as a part of a sentence.
    """

    field: str
    allowed: str


def collision_behavior_problem(behavior: CollisionBehavior) -> ThresholdProblem | None:
    """Return the first threshold that cannot be used; None when all can.

    Args:
        behavior: The thresholds.
    """
    for kind in ("nominal", "acceleration"):
        for what, size in (("torque", _TORQUES), ("force", _FORCES)):
            name = f"lower_{what}_thresholds_{kind}"
            lower = getattr(behavior, name)
            upper = getattr(behavior, name.replace("lower", "upper"))
            if len(lower) != size or len(upper) != size:
                return ThresholdProblem(
                    name, f"{size} numbers for each of the {what} thresholds"
                )
            if any(not 0.0 < a <= b for a, b in zip(lower, upper, strict=True)):
                return ThresholdProblem(
                    name, f"above 0, no lower {what} threshold above its upper one"
                )
    return None
