"""The parameters `command_timeout` and `command_timeout_action`."""

from enum import Enum
from math import inf

from station.core.errors import ParameterError
from station.core.parameters import Parameters


class TimeoutAction(Enum):
    """What a controller does when its set-point expires.

    `command_timeout` [s] is the time for which a set-point is valid; when it is 0 or
    absent, set-points do not expire. `command_timeout_action` is one of:

    - `off`: the set-point stays in force.
    - `hold`, the default: the robot rests until the next set-point arrives.
    - `stop`: the controller fails with `CommandTimeoutError`, and the manager stops it.

    A set-point with a time limit of its own is followed by rest also with `off`.
    """

    OFF = "off"
    HOLD = "hold"
    STOP = "stop"


def read_command_timeout(
    params: Parameters, default: float = 0.0, *, longest: float = inf
) -> tuple[float, TimeoutAction]:
    """Return the validity of set-points [s], 0 for no limit, and the action after it.

    Args:
        params: The controller's namespace.
        default: Validity when `command_timeout` is absent [s].
        longest: Longest validity allowed [s]; when it is finite, every set-point
            expires.

    Raises:
        ParameterError: `command_timeout` is not a number >= 0 or is beyond `longest`,
            or `command_timeout_action` is not a value of `TimeoutAction`.
    """
    is_required = longest < inf
    timeout = params.get_float("command_timeout", default)
    if not 0.0 <= timeout < inf or not 0.0 < (timeout or inf) <= longest:
        bounds = f"more than 0 and at most {longest} s" if is_required else ">= 0 s"
        raise ParameterError(
            f"Parameter '{params.resolve('command_timeout')}' is {timeout}; it must be "
            f"{bounds}.",
            remedy="Give a time in seconds"
            + ("." if is_required else ", or 0 for no timeout."),
            details={"parameter": params.resolve("command_timeout")},
        )
    action = params.get_str("command_timeout_action", TimeoutAction.HOLD.value)
    allowed = [
        each.value
        for each in TimeoutAction
        if not (is_required and each is TimeoutAction.OFF)
    ]
    if action not in allowed:
        raise ParameterError(
            f"Parameter '{params.resolve('command_timeout_action')}' is '{action}'; "
            f"allowed are {', '.join(allowed)}.",
            remedy="Choose one of these actions.",
            details={"parameter": params.resolve("command_timeout_action")},
        )
    chosen = TimeoutAction(action)
    return (0.0 if chosen is TimeoutAction.OFF else timeout), chosen
