"""Set-points: a mailbox that any thread posts to, and the set-point in force."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from math import inf

from station.core.clock import Clock, SystemClock
from station.core.declared_parameter import (
    DeclaredParameter,
    declare_number,
    declare_string,
)
from station.core.errors import (
    CommandTimeoutError,
    InvalidCommandError,
    counted,
    is_number,
    refuse_non_number,
)
from station.core.parameters import Parameters
from station.core.ports.command_ticket import CommandTicket
from station.memory.doubles import put, zeros

RANGE_TOLERANCE = 1e-4
"""Distance beyond its range at which a position may be commanded [rad or m].

People write numbers with four digits, and a joint may rest a little beyond its limit.
"""
_LENGTHS = {"rad", "m"}
"""The units of positions."""
_INF: float = inf


@dataclass(frozen=True, slots=True)
class SetPointElement:
    """One number of a set-point.

    Attributes:
        name: The commanded quantity, usually named after a joint.
        unit: The unit of the number.
        minimum: Smallest allowed value; -inf if unlimited.
        maximum: Largest allowed value; inf if unlimited.
    """

    name: str
    unit: str
    minimum: float = float("-inf")
    maximum: float = float("inf")


@dataclass(frozen=True, slots=True)
class SetPoint:
    """The form of a controller's set-points, and the last one that it picked up.

    Attributes:
        elements: Name, unit and range of each number.
        values: The last set-point picked up; None before the first.
    """

    elements: tuple[SetPointElement, ...]
    values: tuple[float, ...] | None


class SetPointPort:
    """Take set-points from any thread; the control thread picks the newest one up.

    A set-point may be valid for a limited time only, so that the robot does not go on
    moving when its commander has fallen silent. The time counts from `post` on the wall
    clock, which also runs while the simulation is paused.

    Args:
        elements: Name, unit and range of each number of a set-point, in order.
        timeout: How long a set-point is valid [s]; 0 without limit.
        longest: Longest validity that a set-point may ask for [s].
        clock: The clock that measures the validity.

    Attributes:
        feed_forward: The rates of change that may follow the numbers of a set-point.
            Empty if the controller does not use any.
        generation: How often the set-points were made void.
        deadline: When the set-point in force expires [s]; infinite when it does not.
        last: The last set-point picked up, with its rates; None if there was none since
            the controller started.
    """

    def __init__(
        self,
        elements: list[SetPointElement],
        *,
        timeout: float = 0.0,
        longest: float = inf,
        clock: Clock | None = None,
    ) -> None:
        self.elements = elements
        self.timeout = timeout
        self.longest = longest
        self.clock: Clock = SystemClock() if clock is None else clock
        self.feed_forward: list[SetPointElement] = []
        self.last: list[float] | None = None
        # Appending and popping are atomic, so that no set-point is lost without a lock.
        # Without values, the entry lets the set-point in force expire.
        self._slot: deque[
            tuple[list[float] | None, float, int, CommandTicket | None]
        ] = deque(maxlen=1)
        self.is_void = False
        self.deadline = inf
        self.generation = 0
        self._in_force: CommandTicket | None = None
        # The set-point posted last and its generation; None once it is not in force.
        self._newest: tuple[list[float], int] | None = None

    @property
    def newest(self) -> list[float] | None:
        """The set-point posted last, picked up or not, with its rates.

        None if there was none since the controller started, and once it has expired or
        was made void: the controller is at rest then.
        """
        newest = self._newest
        return newest[0] if newest and newest[1] == self.generation else None

    def check(
        self,
        values: list[float],
        timeout: float | None = None,
        rates: list[float] | None = None,
    ) -> None:
        """Refuse a malformed set-point.

        Args:
            values: The set-point.
            timeout: How long it is valid [s], 0 without limit; None takes the port's
                timeout.
            rates: Rates of change in the order of `feed_forward`; None if unknown.

        Raises:
            InvalidCommandError: The length is wrong, a number is not finite or out of
                its range, or the timeout is longer than `longest`.
        """
        if timeout is not None and not 0.0 < (timeout or inf) <= self.longest:
            raise InvalidCommandError(
                f"The timeout of the command is {timeout} s; allowed is more than 0 "
                f"and at most {self.longest} s.",
                remedy="Leave the timeout out, and send set-points repeatedly.",
                details={"timeout": timeout, "longest": self.longest},
            )
        self.check_values(values)
        if rates is not None and not self.feed_forward:
            raise InvalidCommandError(
                "This controller does not use the rates of its set-points.",
                remedy="Leave the rates out, or use a PID position controller.",
            )
        if rates is not None:
            _check_values(self.feed_forward, rates)

    def check_values(self, values: list[float]) -> None:
        """Refuse values of the wrong number, not finite or out of their range.

        Args:
            values: The set-point.

        Raises:
            InvalidCommandError: A value is refused.
        """
        _check_values(self.elements, values)

    def post(
        self,
        values: list[float],
        timeout: float | None = None,
        generation: int | None = None,
        ticket: CommandTicket | None = None,
    ) -> None:
        """Put a checked set-point into the slot; an older one there is replaced.

        Args:
            values: The set-point, with its rates if there are any.
            timeout: How long it is valid [s], 0 without limit; None takes the port's
                timeout.
            generation: The generation in which the sender decided on the set-point,
                which is dropped if the generation is over. None takes the present one.
            ticket: Notes the cycle that takes the set-point.
        """
        limit = self.timeout if timeout is None else timeout
        deadline = self.clock.now() + limit if limit > 0.0 else inf
        of = self.generation if generation is None else generation
        posted = list(values)
        self._newest = (posted, of)
        self._slot.append((posted, deadline, of, ticket))

    def expire(self) -> None:
        """Let the set-point in force expire now, and drop the one in the slot.

        Without a set-point in force, only the slot is emptied.
        """
        self._newest = None
        self._slot.append((None, -inf, self.generation, None))

    def has_changed(self) -> bool:
        """Return whether a set-point waits, was made void, or has become invalid.

        Otherwise the set-point in force stays in force. Control thread only.
        """
        return (
            len(self._slot) > 0
            or self.is_void
            or (self.deadline != _INF and self._has_expired())
        )

    def take(self) -> list[float] | None:
        """Empty the slot and return its set-point, or None. Control thread only."""
        if not self._slot:
            return None
        values, deadline, generation, ticket = self._slot.pop()
        if generation != self.generation:
            return None
        if values is None:
            if self.last is not None:
                self.deadline = deadline
            return None
        self.last, self.deadline, self._in_force = values, deadline, ticket
        if ticket is not None:
            ticket.accept()
        return self.last

    def take_expiry(self) -> bool:
        """Return whether the set-point picked up last has just become invalid.

        The result is True once for each set-point. Called after `take` in every cycle,
        in the control thread only.
        """
        if not self._has_expired():
            return False
        self.deadline = inf
        newest = self._newest
        if newest is not None and newest[0] is self.last:
            self._newest = None
        if self._in_force is not None:
            self._in_force.end()
        return True

    def take_changes(self) -> tuple[bool, list[float] | None, bool]:
        """Empty the slot for a port that follows this one. In an update only.

        Returns:
            Whether set-points became void, the set-point that was picked up or None,
            and whether the set-point in force has expired.
        """
        return self.take_void(), self.take(), self.take_expiry()

    def follow_changes(self, changes: tuple[bool, list[float] | None, bool]) -> None:
        """Take the changes of the port that this one follows."""
        was_void, values, has_expired = changes
        if was_void:
            self.clear()
        # The other port says when it expires.
        deadline = -inf if has_expired else inf
        if values is not None:
            self._slot.append((values, deadline, self.generation, None))
        elif self.last is not None:
            self.deadline = deadline

    def clear(self) -> None:
        """Make every set-point void, picked up or not. Control thread only."""
        self._slot.clear()
        self.last = None
        self.deadline = inf
        self.is_void = True
        self.generation += 1

    def take_void(self) -> bool:
        """Return whether set-points became void since the last call. Control thread."""
        was_void = self.is_void
        self.is_void = False
        return was_void

    def _has_expired(self) -> bool:
        return self.deadline != _INF and self.clock.now() > self.deadline


class TimeoutAction(Enum):
    """A controller's reaction to an expired set-point.

    `command_timeout` [s] is the time for which a set-point is valid; when it is 0 or
    absent, set-points do not expire. `command_timeout_action` is one of:

    - `off`: the set-point stays in force.
    - `hold`, the default: the robot rests until the next set-point arrives.
    - `stop`: the controller fails with `CommandTimeoutError`, and the manager stops it.

    When a set-point with a time limit of its own expires, the robot rests even with
    `off`.
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
        declare_number(
            "command_timeout",
            "time on the wall clock after which a set-point expires" + never,
            default,
            "s",
            minimum=0.0,
            excludes_minimum=always,
            maximum=longest,
        ),
        declare_string(
            "command_timeout_action",
            follows,
            TimeoutAction.HOLD.value,
            choices=tuple(
                each.value
                for each in TimeoutAction
                if not (always and each is TimeoutAction.OFF)
            ),
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


class ActiveSetPoint:
    """The set-point in force: the newest valid one of a port, or rest. Control thread.

    Args:
        port: Receives the set-points.
        action: Reaction when the newest set-point expires.
        subject: Name of the commanded thing, for messages.
        rest: Returns the set-point at which the robot rests, shape (n,).

    Attributes:
        port: As given.
        values: The set-point in force, shape (n,); never changed, only replaced.
        desired: The values, always in the same memory.
        desired_rates: Rates at which the values change, always in the same memory.
        has_rates: Whether the rates are known.
    """

    def __init__(
        self,
        port: SetPointPort,
        action: TimeoutAction,
        subject: str,
        rest: Callable[[], list[float]],
    ) -> None:
        self.port = port
        self._action = action
        self._subject = subject
        self._rest = rest
        self.values: list[float] = []
        self.desired = zeros(len(port.elements))
        self.desired_rates = zeros(len(port.elements))
        self.has_rates = False

    def start_at_rest(self) -> None:
        """Make rest the set-point; called when the controller starts."""
        self._put_in_force(self._rest(), [])

    def newest(self) -> list[float]:
        """Return the set-point in force, shape (n,); the caller must not change it.

        The set-point is clamped to the ranges of its elements. Rest replaces a
        set-point that has expired, or that a stop, a reset or a recovery made void.

        Raises:
            CommandTimeoutError: The set-point has expired and the action is `stop`.
        """
        if self.port.has_changed():
            self._replace()
        return self.values

    def _replace(self) -> None:
        port = self.port
        if port.take_void():
            self.start_at_rest()
        newest = port.take()
        if newest is not None:
            # Set-points may be posted unchecked, so they are clamped once more here.
            # After the values come the rates, if the set-point has any.
            values = [
                min(max(value, element.minimum), element.maximum)
                for value, element in zip(newest, port.elements, strict=False)
            ]
            self._put_in_force(values, newest[len(values) :])
        if port.take_expiry():
            self._end()

    def _put_in_force(self, values: list[float], rates: list[float]) -> None:
        put(self.desired, values)
        if rates:
            put(self.desired_rates, rates)
        self.has_rates = bool(rates)
        self.values = values

    def _end(self) -> None:
        if self._action is TimeoutAction.STOP:
            raise CommandTimeoutError(
                f"No set-point for {self._subject} arrived in time.",
                remedy="Restart the controller, and send set-points more often than "
                "its `command_timeout` demands.",
            )
        self.start_at_rest()
        self.port.last = self.values


def _check_values(elements: list[SetPointElement], values: list[float]) -> None:
    """Refuse values that do not fit `elements`.

    Raises:
        InvalidCommandError: The length is wrong, or a value is not finite or out of
            its range.
    """
    if len(values) != len(elements):
        names = ", ".join(element.name for element in elements)
        raise InvalidCommandError(
            f"The command has {counted(len(values), 'value')}; this controller takes "
            f"{len(elements)}: {names}.",
            remedy="Send one number per element, in that order.",
            details={"expected": [e.name for e in elements]},
        )
    for element, value in zip(elements, values, strict=True):
        if not is_number(value):
            refuse_non_number(element.name, value)
        allowed = element.minimum <= value <= element.maximum or (
            element.unit in _LENGTHS
            and element.minimum - RANGE_TOLERANCE <= value
            and value <= element.maximum + RANGE_TOLERANCE
        )
        if not allowed or value - value != 0:
            raise InvalidCommandError(
                f"The command for '{element.name}' is {value}; allowed is "
                f"{element.minimum} to {element.maximum} {element.unit}.",
                remedy="Send finite numbers within the range.",
                details={"element": element.name},
            )
