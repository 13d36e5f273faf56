"""Run-time parameters of a controller: names, units, ranges, values, and changes."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from station.core.errors import InvalidGainError, suggest


@dataclass(frozen=True, slots=True)
class Tunable:
    """A number that may change while the controller runs.

    Attributes:
        unit: Its unit, e.g. `Nm/rad`; empty for a number without a unit.
        minimum: Smallest value allowed.
        maximum: Largest value allowed; also the end of a slider.
        description: One line for people.
        parameter: Path of the parameter that gives its first value, below the
            controller's namespace, e.g. `gains/joint1/p`; `stiffness[2]` is an element
            of a list. Empty for the parameter of its own name, if there is one.
    """

    unit: str = ""
    minimum: float = 0.0
    maximum: float = 1e6
    description: str = ""
    parameter: str = ""

    def including(self, value: float) -> "Tunable":
        """Return this description, with the range extended to a configured value."""
        least, most = min(self.minimum, value), max(self.maximum, value)
        return replace(self, minimum=least, maximum=most)


class Tunables:
    """The run-time parameters of one controller.

    A controller declares them once and reads `values` in `update`:

    ```python
    def init(self, interface, params):
        self.tunables = Tunables(
            {"stiffness": Tunable("Nm/rad", 0.0, 100.0, "Pull towards the target")},
            {"stiffness": params.get_float("stiffness", 20.0)},
        )

    def update(self, time, period):
        stiffness = self.tunables.values["stiffness"]
    ```

    Any thread may read `schema` and `values` and call `checked`. `apply` is called
    between two cycles only, so that `update` never sees half of a change.

    Args:
        schema: Unit and range by name.
        values: First values; the same names in the same order as `schema`.
        check: Refuses a complete set whose values do not fit together, by raising
            InvalidGainError. Every value in the set is in its range already. Not called
            in the control thread.
        apply: Receives a complete, checked set whenever it takes effect, for numbers
            that the controller keeps in another form. Called between two cycles; it
            must return quickly and not fail.
        notes: Returns a sentence about each value of a complete set that has no effect.
            Any thread.

    Attributes:
        schema: Unit and range by name.
        values: The values in force by name. A change replaces the mapping as a whole.
        configured: The first values, by name.
        when_idle: Calls a function as soon as no update is under way: immediately,
            unless the controller is asynchronous.

    Raises:
        ValueError: `schema` and `values` have different names.
    """

    def __init__(
        self,
        schema: Mapping[str, Tunable] | None = None,
        values: Mapping[str, float] | None = None,
        *,
        check: Callable[[Mapping[str, float]], None] | None = None,
        apply: Callable[[Mapping[str, float]], None] | None = None,
        notes: Callable[[Mapping[str, float]], list[str]] | None = None,
    ) -> None:
        self.schema: dict[str, Tunable] = dict(schema or {})
        self.values: dict[str, float] = dict(values or {})
        self.configured = self.values
        # The set that waits for the end of an update.
        self._waiting: dict[str, float] | None = None
        if set(self.schema) != set(self.values):
            raise ValueError(
                f"The schema names {list(self.schema)}, but there are values for "
                f"{list(self.values)}. Give one value for each name."
            )
        self._check = check
        self._apply = apply
        self._notes = notes
        self.when_idle: Callable[[Callable[[], None]], None] = lambda change: change()

    @classmethod
    def joined(cls, *parts: "Tunables") -> "Tunables":
        """Return one object with the run-time parameters of all parts.

        Args:
            parts: Run-time parameters with different names. A change of the result is
                checked and applied by the part that the name belongs to.
        """

        def check(values: Mapping[str, float]) -> None:
            for part in parts:
                part.check_together(values)

        def apply(values: Mapping[str, float]) -> None:
            for part in parts:
                part.apply({name: values[name] for name in part.schema})

        def notes(values: Mapping[str, float]) -> list[str]:
            return [note for part in parts for note in part.notes(values)]

        return cls(
            {name: tunable for part in parts for name, tunable in part.schema.items()},
            {name: value for part in parts for name, value in part.values.items()},
            check=check,
            apply=apply,
            notes=notes,
        )

    def checked(self, changes: Mapping[str, float]) -> dict[str, float]:
        """Return the complete set that `changes` lead to, without applying it.

        Args:
            changes: New values by name; the other values stay.

        Raises:
            InvalidGainError: A name is unknown, a value is not a finite number in its
                range, or the values do not fit together. `details["errors"]` lists
                every name and value that is not allowed.
        """
        errors: list[dict[str, object]] = []
        for name, value in changes.items():
            problem = self._problem(name, value)
            if problem is not None:
                errors.append({"field": name, "value": repr(value), "message": problem})
        if errors:
            first = errors[0]
            more = f" ({len(errors) - 1} more)" if len(errors) > 1 else ""
            raise InvalidGainError(
                f"Gain '{first['field']}' {first['message']}{more}.",
                remedy="Send values within the ranges of the schema; none was applied.",
                details={"errors": errors},
            )
        values = {**(self._waiting or self.values), **changes}
        self.check_together(values)
        return values

    def check_together(self, values: Mapping[str, float]) -> None:
        """Refuse a complete set whose values do not fit together.

        Args:
            values: A value in its range for every name; other names are ignored.

        Raises:
            InvalidGainError: The values do not fit together.
        """
        if self._check is not None:
            self._check(values)

    def notes(self, values: Mapping[str, float]) -> list[str]:
        """Return a sentence about each value of a complete set that has no effect.

        Args:
            values: A value for every name; other names are ignored.
        """
        return [] if self._notes is None else self._notes(values)

    def apply(self, values: Mapping[str, float]) -> None:
        """Put a set that `checked` has returned into force. Between two cycles only.

        Args:
            values: A value for every name.
        """
        self._waiting = dict(values)
        self.when_idle(self._put_into_force)

    def _put_into_force(self) -> None:
        if self._waiting is not None:
            self.values, self._waiting = self._waiting, None
            if self._apply is not None:
                self._apply(self.values)

    def _problem(self, name: str, value: float) -> str | None:
        tunable = self.schema.get(name)
        if tunable is None:
            return f"is unknown. {suggest(name, self.schema).rstrip('.')}"
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            return f"is {value!r}; it must be a number"
        # One chained comparison, so that NaN is refused, too.
        if not tunable.minimum <= value <= tunable.maximum:
            unit = f" {tunable.unit}" if tunable.unit else ""
            return (
                f"is {value}; allowed is {tunable.minimum} to {tunable.maximum}{unit}"
            )
        return None


@dataclass(frozen=True, slots=True)
class Gains:
    """A client's view of a controller's run-time parameters.

    Attributes:
        values: Present value by name.
        schema: Unit and range by name.
        revision: Number of changes so far; equal revisions mean equal values.
    """

    values: dict[str, float]
    schema: dict[str, Tunable]
    revision: int
