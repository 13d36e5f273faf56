"""The parameters `command_timeout` and `command_timeout_action`."""

from enum import Enum
from math import inf

from station.core.declared_parameter import DeclaredParameter, ParameterType
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


def timeout_parameters(
    default: float = 0.0, *, longest: float = inf
) -> tuple[DeclaredParameter, DeclaredParameter]:
    """Return the declarations of `command_timeout` and `command_timeout_action`.

    Args:
        default: Validity of a set-point when `command_timeout` is absent [s].
        longest: Longest validity allowed [s]; when it is finite, every set-point
            expires.
    """
    always = longest < inf
    never = "" if always else "; 0: never"
    follows = (
        "what follows: come to rest and `hold`, or `stop` (the controller fails)"
        if always
        else "what follows: `hold` (rest), `stop` (the controller fails) or `off` "
        "(nothing)"
    )
    return (
        DeclaredParameter(
            name="command_timeout",
            type=ParameterType.NUMBER,
            unit="s",
            default=default,
            minimum=0.0,
            excludes_minimum=always,
            maximum=longest,
            description="time on the wall clock after which a set-point expires"
            + never,
        ),
        DeclaredParameter(
            name="command_timeout_action",
            type=ParameterType.STRING,
            default=TimeoutAction.HOLD.value,
            choices=tuple(
                each.value
                for each in TimeoutAction
                if not (always and each is TimeoutAction.OFF)
            ),
            description=follows,
        ),
    )


def read_command_timeout(
    params: Parameters, default: float = 0.0, *, longest: float = inf
) -> tuple[float, TimeoutAction]:
    """Return the validity of set-points [s], 0 for no limit, and the action after it.

    Args:
        params: The controller's namespace.
        default: See `timeout_parameters`.
        longest: See `timeout_parameters`.

    Raises:
        ParameterError: `command_timeout` is not a number >= 0 or is beyond `longest`,
            or `command_timeout_action` is not a value of `TimeoutAction`.
    """
    validity, action = timeout_parameters(default, longest=longest)
    timeout = validity.read_float(params)
    chosen = TimeoutAction(action.read_str(params))
    return (0.0 if chosen is TimeoutAction.OFF else timeout), chosen
