"""What happens when whoever commands a controller falls silent."""

from enum import Enum
from math import inf

from station.core.errors import ParameterError
from station.core.parameters import Parameters


class TimeoutAction(Enum):
    """What a controller does when its set-point is no longer valid.

    Parameters of the controllers that use it: `command_timeout` [s], how long a
    set-point is valid, for ever when 0 or absent, and `command_timeout_action`:

    - `off`: nothing; the set-point stays in force.
    - `hold`, the default: rest, and go on with the next set-point.
    - `stop`: fail with `CommandTimeoutError`, upon which the manager takes the
      controller off the robot.

    A set-point that brings its own time limit is followed by `hold`, also with `off`.
    """

    OFF = "off"
    HOLD = "hold"
    STOP = "stop"


def read_command_timeout(
    params: Parameters, default: float = 0.0, *, longest: float = inf
) -> tuple[float, TimeoutAction]:
    """Return how long a set-point is valid [s], 0 for ever, and what happens then.

    Args:
        params: The controller's namespace.
        default: Validity when `command_timeout` is absent [s].
        longest: Longest validity [s]; when finite, every set-point ends by itself.

    Raises:
        ParameterError: `command_timeout` is no number >= 0, or
            `command_timeout_action` is not one of `TimeoutAction`, or the timeout is
            beyond `longest`.
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
            remedy="Choose one of them.",
            details={"parameter": params.resolve("command_timeout_action")},
        )
    chosen = TimeoutAction(action)
    return (0.0 if chosen is TimeoutAction.OFF else timeout), chosen
