"""The thresholds of contact and collision: defaults, checks, and warnings."""

from dataclasses import dataclass

from station.core.errors import InvalidCommandError
from station.core.franka.franka_errors import ArmError
from station.core.franka.franka_robot_state import RobotState
from station.core.franka.franka_services import CollisionBehavior
from station.hw.franka.arm.service_limits import field_error

DEFAULT_COLLISION_BEHAVIOR = CollisionBehavior(
    *((20.0, 20.0, 18.0, 18.0, 16.0, 14.0, 12.0),) * 4,
    *((20.0, 20.0, 20.0, 25.0, 25.0, 25.0),) * 4,
)
"""Thresholds as franka_control configures them; contact and collision coincide."""
NEAR = 0.8
"""Share of its threshold above which an estimate counts as near a collision."""
_TORQUES, _FORCES = 7, 6
_AXES = ("x", "y", "z", "roll", "pitch", "yaw")


@dataclass(frozen=True, slots=True)
class ThresholdProblem:
    """A threshold that cannot be used.

    Attributes:
        field: Name of the threshold in `CollisionBehavior`.
        allowed: Allowed values, as a part of a sentence.
    """

    field: str
    allowed: str


def collision_behavior_problem(behavior: CollisionBehavior) -> ThresholdProblem | None:
    """Return the first threshold that cannot be used; None if all can.

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
            # With a threshold of 0, noise would be a contact of an arm at rest.
            if any(not 0.0 < a <= b for a, b in zip(lower, upper, strict=True)):
                return ThresholdProblem(
                    name, f"above 0, no lower {what} threshold above its upper one"
                )
    return None


def check_collision_behavior(behavior: CollisionBehavior) -> None:
    """Refuse thresholds that cannot be used.

    Args:
        behavior: The thresholds.

    Raises:
        InvalidCommandError: A threshold cannot be used.
    """
    problem = collision_behavior_problem(behavior)
    if problem is not None:
        field, allowed = problem.field, problem.allowed
        value = list(getattr(behavior, field))
        raise InvalidCommandError(
            f"The collision threshold '{field}' is {value}; it must be {allowed}.",
            remedy="Give all thresholds, also those that stay as they are.",
            details=field_error(field, f"must be {allowed}", value),
        )


def thresholds_of(
    behavior: CollisionBehavior, bound: str, phase: str
) -> tuple[float, ...]:
    """Return the thresholds of the torques, then of the wrench, shape (13,).

    Args:
        behavior: All thresholds.
        bound: `lower` or `upper`.
        phase: `nominal` or `acceleration`.
    """
    torques: tuple[float, ...] = getattr(behavior, f"{bound}_torque_thresholds_{phase}")
    forces: tuple[float, ...] = getattr(behavior, f"{bound}_force_thresholds_{phase}")
    return (*torques, *forces)


def collision_error(signal: int, value: float, bound: float) -> ArmError:
    """Return the error of an estimate that is above its threshold.

    Args:
        signal: Index of the estimate, 0 to 12: the 7 torques, then the wrench's 6
            components.
        value: The estimate [Nm, N].
        bound: Threshold of the estimate, in the same unit.
    """
    if signal < _TORQUES:
        return ArmError("joint_reflex", f"joint{signal + 1}", value, bound, "Nm")
    axis = signal - _TORQUES
    unit = "N" if axis < 3 else "Nm"
    return ArmError("cartesian_reflex", _AXES[axis], value, bound, unit)


def near_collisions(state: RobotState, behavior: CollisionBehavior) -> list[ArmError]:
    """Return the errors that slightly larger estimates would raise.

    Args:
        state: State of the arm.
        behavior: The thresholds in force.
    """
    values = (*state.tau_ext_hat_filtered, *state.K_F_ext_hat_K)
    bounds = thresholds_of(behavior, "upper", "nominal")
    return [
        collision_error(signal, value, bound)
        for signal, (value, bound) in enumerate(zip(values, bounds, strict=True))
        if abs(value) > NEAR * bound
    ]
