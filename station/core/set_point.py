"""The one-slot mailbox through which a controller gets its set-points."""

from dataclasses import dataclass

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

    Args:
        elements: What the numbers of a set-point are, in order.
    """

    def __init__(self, elements: list[SetPointElement]) -> None:
        self.elements = elements
        self._slot: list[float] | None = None
        self.last: list[float] | None = None

    def check(self, values: list[float]) -> None:
        """Refuse a malformed set-point.

        Raises:
            InvalidCommandError: Wrong length, or an element is not finite or out of
                its range.
        """
        names = ", ".join(element.name for element in self.elements)
        if len(values) != len(self.elements):
            raise InvalidCommandError(
                f"The command has {len(values)} values; this controller takes "
                f"{len(self.elements)}: {names}.",
                remedy="Send one number per element, in that order.",
                details={"expected": [e.name for e in self.elements]},
            )
        for element, value in zip(self.elements, values, strict=True):
            if not element.minimum <= value <= element.maximum or value - value != 0:
                raise InvalidCommandError(
                    f"The command for '{element.name}' is {value}; allowed is "
                    f"{element.minimum} to {element.maximum} {element.unit}.",
                    remedy="Send finite numbers within the range.",
                    details={"element": element.name},
                )

    def post(self, values: list[float]) -> None:
        """Put a checked set-point into the slot; an older one there is replaced."""
        self._slot = list(values)

    def take(self) -> list[float] | None:
        """Return the newest set-point and empty the slot (control thread only)."""
        values = self._slot
        if values is not None:
            self._slot = None
            self.last = values
        return values

    def clear(self) -> None:
        """Void a set-point that has not been picked up (control thread only)."""
        self._slot = None
