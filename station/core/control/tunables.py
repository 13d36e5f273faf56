"""Run-time parameters of a controller: what they are called, their unit and range."""

from collections.abc import Mapping
from dataclasses import dataclass

from station.core.errors import InvalidGainError


@dataclass(frozen=True, slots=True)
class Tunable:
    """A number that may change while the controller runs.

    Attributes:
        unit: Its unit, e.g. `Nm/rad`; empty for a plain number.
        minimum: Smallest value allowed.
        maximum: Largest value allowed; also what a slider needs.
        description: One line for people.
    """

    unit: str = ""
    minimum: float = 0.0
    maximum: float = 1e6
    description: str = ""


def check_tunables(
    schema: Mapping[str, Tunable],
    current: Mapping[str, float],
    changes: Mapping[str, float],
) -> dict[str, float]:
    """Return `current` with `changes` applied, when every change is allowed.

    Raises:
        InvalidGainError: A name is unknown, or a value is not a finite number in its
            range. Nothing is changed then; `details["errors"]` lists all of them.
    """
    errors: list[dict[str, object]] = []
    for name, value in changes.items():
        problem = _problem(schema, name, value)
        if problem:
            errors.append({"field": name, "value": repr(value), "message": problem})
    if errors:
        first = errors[0]
        more = f" ({len(errors) - 1} more)" if len(errors) > 1 else ""
        raise InvalidGainError(
            f"Gain '{first['field']}' {first['message']}{more}.",
            remedy="Send values within the ranges of the schema; none was applied.",
            details={"errors": errors},
        )
    return {**current, **changes}


def _problem(schema: Mapping[str, Tunable], name: str, value: float) -> str:
    tunable = schema.get(name)
    if tunable is None:
        return f"is unknown; known are {', '.join(schema) or 'none'}"
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return f"is {value!r}; it must be a number"
    if not tunable.minimum <= value <= tunable.maximum:
        unit = f" {tunable.unit}" if tunable.unit else ""
        return f"is {value}; allowed is {tunable.minimum} to {tunable.maximum}{unit}"
    return ""


@dataclass(frozen=True, slots=True)
class Gains:
    """The run-time parameters of a controller.

    Attributes:
        values: Present value by name.
        schema: Unit and range by name.
        revision: Counts changes; equal revisions mean equal values.
    """

    values: dict[str, float]
    schema: dict[str, Tunable]
    revision: int


@dataclass(frozen=True, slots=True)
class GainsChange:
    """An applied set of gains.

    Attributes:
        values: All values as they are now.
        previous: All values as they were.
        revision: Revision of the new values.
        cycle: The cycle from which on they hold.
    """

    values: dict[str, float]
    previous: dict[str, float]
    revision: int
    cycle: int
