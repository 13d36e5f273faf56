"""The one-slot mailbox through which a controller gets its set-points."""

from collections import deque
from dataclasses import dataclass
from math import inf

from station.core.clock import Clock, SystemClock
from station.core.errors import InvalidCommandError


@dataclass(frozen=True, slots=True)
class SetPointElement:
    """One number of a set-point.

    Attributes:
        name: What it commands, usually a joint.
        unit: Its unit.
        minimum: Smallest value allowed; -inf where unlimited.
        maximum: Largest value allowed; inf where unlimited.
    """

    name: str
    unit: str
    minimum: float = float("-inf")
    maximum: float = float("inf")


@dataclass(frozen=True, slots=True)
class SetPoint:
    """What a controller takes as set-point, and what it got last.

    Attributes:
        elements: Name, unit and range of each number.
        values: The last set-point picked up; None before the first.
    """

    elements: tuple[SetPointElement, ...]
    values: tuple[float, ...] | None


class SetPointPort:
    """Takes set-points from any thread; the control thread picks the newest one up.

    A set-point may be valid for a limited time only, so that the robot does not go on
    when whoever commands it has fallen silent. The time counts from `post` and on the
    wall clock: it also passes while the simulation is paused.

    Args:
        elements: What the numbers of a set-point are, in order.
        timeout: How long a set-point is valid [s]; 0 for ever.
        longest: Longest validity that a set-point may ask for [s].
        clock: The clock that measures it.

    Attributes:
        feed_forward: What may follow the numbers of a set-point: the rates at which
            they change. Empty when the controller has no use for them.
        generation: Counts how often set-points were made void.
        last: The last set-point picked up, with its rates; None when there was none
            since the controller started.
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
        # Appending and popping are atomic: no set-point is lost between them.
        self._slot: deque[tuple[list[float], float, int]] = deque(maxlen=1)
        self.generation = 0
        self._deadline = inf
        self._is_void = False

    def check(
        self,
        values: list[float],
        timeout: float | None = None,
        rates: list[float] | None = None,
    ) -> None:
        """Refuse a malformed set-point.

        Args:
            values: The set-point.
            timeout: How long it shall be valid [s], 0 for ever; None for `timeout`.
            rates: How fast it changes, as `feed_forward` says; None when unknown.

        Raises:
            InvalidCommandError: Wrong length, an element is not finite or out of its
                range, or it shall be valid for too long.
        """
        if timeout is not None and not 0.0 < (timeout or inf) <= self.longest:
            raise InvalidCommandError(
                f"The timeout of the command is {timeout} s; allowed is more than 0 "
                f"and at most {self.longest} s.",
                remedy="Leave it out, and send set-points again and again.",
                details={"timeout": timeout, "longest": self.longest},
            )
        _check_values(self.elements, values)
        if rates is not None and not self.feed_forward:
            raise InvalidCommandError(
                "This controller takes no rates of its set-points.",
                remedy="Leave them out, or use a PID position controller.",
            )
        if rates is not None:
            _check_values(self.feed_forward, rates)

    def post(
        self,
        values: list[float],
        timeout: float | None = None,
        generation: int | None = None,
    ) -> None:
        """Put a checked set-point into the slot; an older one there is replaced.

        Args:
            values: The set-point, with its rates if there are any.
            timeout: How long it is valid [s], 0 for ever; the port's timeout when None.
            generation: The generation in which the sender decided; it is dropped when
                that is over. The present one when None.
        """
        limit = self.timeout if timeout is None else timeout
        deadline = self.clock.now() + limit if limit > 0.0 else inf
        of = self.generation if generation is None else generation
        self._slot.append((list(values), deadline, of))

    def take(self) -> list[float] | None:
        """Return the newest set-point and empty the slot (control thread only)."""
        if not self._slot:
            return None
        values, deadline, generation = self._slot.pop()
        if generation != self.generation:
            return None
        self.last, self._deadline = values, deadline
        return self.last

    def take_expiry(self) -> bool:
        """Say, once, that the set-point picked up last is no longer valid.

        Call it after `take`, in every cycle (control thread only).
        """
        if self._deadline == inf or self.clock.now() <= self._deadline:
            return False
        self._deadline = inf
        return True

    def clear(self) -> None:
        """Void every set-point, picked up or not (control thread only)."""
        self._slot.clear()
        self.last = None
        self._deadline = inf
        self._is_void = True
        self.generation += 1

    def take_void(self) -> bool:
        """Say, once, that what was picked up before is void (control thread only)."""
        was_void = self._is_void
        self._is_void = False
        return was_void


def _check_values(elements: list[SetPointElement], values: list[float]) -> None:
    """Refuse values that are not what `elements` says.

    Raises:
        InvalidCommandError: Wrong length, or a value is not finite or out of range.
    """
    if len(values) != len(elements):
        names = ", ".join(element.name for element in elements)
        raise InvalidCommandError(
            f"The command has {len(values)} values; this controller takes "
            f"{len(elements)}: {names}.",
            remedy="Send one number per element, in that order.",
            details={"expected": [e.name for e in elements]},
        )
    for element, value in zip(elements, values, strict=True):
        if not element.minimum <= value <= element.maximum or value - value != 0:
            raise InvalidCommandError(
                f"The command for '{element.name}' is {value}; allowed is "
                f"{element.minimum} to {element.maximum} {element.unit}.",
                remedy="Send finite numbers within the range.",
                details={"element": element.name},
            )
