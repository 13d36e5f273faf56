"""The limits of requests to a Franka hand: widths, speeds, forces."""

from math import isfinite

from station.core.errors import InvalidCommandError
from station.core.franka import GraspRequest

OPEN_WIDTH = 0.08
"""Distance between the fingers when the hand is open [m]. Source: the limits of the
finger joints in panda.urdf, 0.04 m each."""
FASTEST = 0.4
"""Largest speed of the width [m/s]: twice the speed of a finger in panda.urdf."""
WEAKEST = 0.1
"""Smallest force of a grasp [N]; below it the fingers hardly move."""
MAX_FORCE = 140.0
"""Largest force of each finger [N]. Source: datasheet of the Franka Hand."""


def check_move(arm_id: str, width: float, speed: float, open_width: float) -> None:
    """Refuse a move that the hand cannot make.

    Args:
        arm_id: The arm with the hand.
        width: Distance between the fingers [m].
        speed: Speed at which the width changes [m/s].
        open_width: The largest width [m].

    Raises:
        InvalidCommandError: A number is out of range.
    """
    _check(arm_id, "width", width, 0.0 <= width <= open_width, open_width)
    _check(arm_id, "speed", speed, 0.0 < speed <= FASTEST, open_width)


def check_grasp(arm_id: str, request: GraspRequest, open_width: float) -> None:
    """Refuse a grasp that the hand cannot make.

    Args:
        arm_id: The arm with the hand.
        request: The grasp.
        open_width: The largest width [m].

    Raises:
        InvalidCommandError: A number is out of range.
    """
    inner, outer = request.epsilon_inner, request.epsilon_outer
    for name, value, is_allowed in (
        ("width", request.width, 0.0 <= request.width < open_width),
        ("force", request.force, WEAKEST <= request.force <= MAX_FORCE),
        ("speed", request.speed, 0.0 < request.speed <= FASTEST),
        ("epsilon_inner", inner, inner >= 0.0 and isfinite(inner)),
        ("epsilon_outer", outer, outer >= 0.0 and isfinite(outer)),
    ):
        _check(arm_id, name, value, is_allowed, open_width)


def _check(
    arm_id: str,
    name: str,
    value: float,
    is_allowed: bool,  # noqa: FBT001 - of the value just named
    open_width: float,
) -> None:
    if is_allowed:
        return
    allowed = {
        "width": f"0 to {open_width:g} m, for a grasp less",
        "speed": f"above 0, at most {FASTEST:g} m/s",
        "force": f"{WEAKEST:g} to {MAX_FORCE:g} N",
    }.get(name, "0 m or more")
    error = {
        "field": f"body/{name.replace('epsilon_', 'epsilon/')}",
        "message": f"must be {allowed}",
        "value": f"{value}",
    }
    raise InvalidCommandError(
        f"The gripper of arm '{arm_id}' was given '{name}' {value}; allowed is "
        f"{allowed}.",
        remedy="Give a number in this range.",
        details={"errors": [error]},
    )
