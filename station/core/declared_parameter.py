"""A parameter as a controller declares and reads it: name, type, unit, default, range.

A declaration is written once. The controller reads the parameter through it, and the
API shows it to people who want to load such a controller.
"""

from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass, replace
from enum import Enum
from functools import partial
from math import inf
from typing import NoReturn

from station.core.errors import ParameterError
from station.core.parameters import Parameters

EACH_JOINT = "<joint>"
"""Placeholder in a parameter's name for the name of each joint of the controller."""


class ParameterType(Enum):
    """The type of a parameter's value."""

    NUMBER = "number"
    BOOLEAN = "boolean"
    STRING = "string"
    NUMBERS = "numbers"
    STRINGS = "strings"
    NUMBER_OR_NUMBERS = "number_or_numbers"
    """One number for all joints or axes, or a list with one number for each."""
    MAPPINGS = "mappings"


class NameKind(Enum):
    """The kind of things that the strings of a parameter name."""

    NOTHING = ""
    JOINT = "joint"
    ARM = "arm"
    CONTROLLER = "controller"


@dataclass(frozen=True, slots=True)
class DeclaredParameter:
    """A parameter that a controller reads when it is loaded.

    The methods that read it apply its name, its default and its range, and refuse a
    value that is not allowed. Not for the control thread.

    Attributes:
        type: Type of the value.
        name: Path below the namespace of the controller, e.g. `constraints/goal_time`;
            `<joint>` in the path stands for the name of each joint.
        description: Purpose, a phrase without a full stop.
        default: Value when the parameter is absent; None when there is no fixed one.
        unit: Unit of the numbers, empty without a unit; where a joint may turn or
            slide, the unit for a joint that turns.
        default_text: How the default follows from the robot or other parameters; empty
            when the default is fixed or the parameter is required.
        minimum: Smallest number allowed.
        excludes_minimum: Whether the number must be larger than `minimum`.
        maximum: Largest number allowed.
        choices: The strings allowed; empty when any is.
        size: Length that a list must have; None when any is allowed.
        names: Kind of things that the strings name.

    Raises:
        ValueError: Default and choices contradict each other.
    """

    type: ParameterType
    name: str
    description: str
    default: float | bool | str | tuple[float, ...] | tuple[str, ...] | None = None
    unit: str = ""
    _: KW_ONLY
    default_text: str = ""
    minimum: float = -inf
    excludes_minimum: bool = False
    maximum: float = inf
    choices: tuple[str, ...] = ()
    size: int | None = None
    names: NameKind = NameKind.NOTHING

    def __post_init__(self) -> None:
        if self.choices and self.default not in {None, *self.choices}:
            raise ValueError(
                f"The default of '{self.name}' is {self.default!r}; choose one of "
                f"{self.choices}."
            )

    @property
    def is_required(self) -> bool:
        """Return whether loading fails when the parameter is absent."""
        return self.default is None and not self.default_text

    def inside(self, namespace: str) -> "DeclaredParameter":
        """Return the same parameter in a namespace below that of the controller."""
        return replace(self, name=f"{namespace}/{self.name}")

    def of(self, joint: str) -> "DeclaredParameter":
        """Return the parameter of one joint."""
        return replace(self, name=self.name.replace(EACH_JOINT, joint))

    def read_float(self, params: Parameters, default: float | None = None) -> float:
        """Return the parameter's value, a number.

        Args:
            params: The namespace in which the parameter is declared.
            default: Value when it is absent and no default is declared.

        Raises:
            ParameterError: The value is missing, not finite, or out of its range.
        """
        declared = self.default if isinstance(self.default, (int, float)) else default
        value = params.get_float(self.name, declared)
        self._check(params, [value], value)
        return value

    def read_bool(self, params: Parameters) -> bool:
        """Return the parameter's value, a boolean.

        Args:
            params: The namespace in which the parameter is declared.

        Raises:
            ParameterError: The value is missing, or neither true nor false.
        """
        declared = self.default if isinstance(self.default, bool) else None
        return params.get_bool(self.name, default=declared)

    def read_str(self, params: Parameters) -> str:
        """Return the parameter's value, a string.

        Args:
            params: The namespace in which the parameter is declared.

        Raises:
            ParameterError: The value is missing, not a string, or none of the choices.
        """
        declared = self.default if isinstance(self.default, str) else None
        value = params.get_str(self.name, declared)
        if self.choices and value not in self.choices:
            self.refuse(params, f"'{value}'", f"one of {', '.join(self.choices)}")
        return value

    def read_str_list(
        self, params: Parameters, default: Sequence[str] | None = None
    ) -> list[str]:
        """Return the parameter's value, a list of strings.

        Args:
            params: The namespace in which the parameter is declared.
            default: Value when it is absent and no default is declared.

        Raises:
            ParameterError: The value is missing, or not a list of strings.
        """
        if isinstance(self.default, tuple):
            default = [str(each) for each in self.default]
        return params.get_str_list(
            self.name, None if default is None else list(default)
        )

    def read_float_list(self, params: Parameters) -> list[float]:
        """Return the parameter's value, a list of numbers.

        Args:
            params: The namespace in which the parameter is declared.

        Raises:
            ParameterError: The value is missing, not a list of finite numbers, has
                another length, or a number is out of its range.
        """
        values = params.get_float_list(self.name, self.size, self._default_numbers())
        self._check(params, values, values)
        return values

    def read_per_axis(
        self, params: Parameters, default: Sequence[float] | None = None
    ) -> list[float]:
        """Return one number for each axis, from one number for all or from a list.

        Args:
            params: The namespace in which the parameter is declared.
            default: Values when the parameter is absent; their count is the number of
                axes. An infinite value means that the parameter is required. None takes
                the declared default.

        Raises:
            ParameterError: The value is missing, the numbers are too many or too few,
                or a number is not finite or out of its range.
        """
        usual = list(default or self._default_numbers() or ())
        if not params.has(self.name):
            values = usual
        elif isinstance(params.get(self.name), list):
            values = params.get_float_list(self.name)
        else:
            values = [params.get_float(self.name)] * len(usual)
        if len(values) != len(usual):
            self.refuse(params, values, f"{len(usual)} numbers, or one for all")
        if inf in values:
            self.refuse(params, "missing", self.allowed())
        self._check(params, values, values)
        return values

    def allowed(self) -> str:
        """Return the range of the numbers in words, e.g. `above 0 and at most 1 s`."""
        unit = f" {self.unit}" if self.unit else ""
        if self.maximum == inf:
            return f"{'>' if self.excludes_minimum else '>='} {self.minimum:g}{unit}"
        if self.excludes_minimum:
            return f"above {self.minimum:g} and at most {self.maximum:g}{unit}"
        return f"between {self.minimum:g} and {self.maximum:g}{unit}"

    def refuse(self, params: Parameters, value: object, allowed: str) -> NoReturn:
        """Refuse a value of the parameter.

        Args:
            params: The namespace in which the parameter is declared.
            value: The value, as text for the message.
            allowed: Allowed values, after the words "it must be".

        Raises:
            ParameterError: Always.
        """
        place = params.resolve(self.name)
        way_out = "" if self.is_required else ", or leave the parameter out"
        raise ParameterError(
            f"Parameter '{place}' is {value}; it must be {allowed}.",
            remedy=f"Correct the value{way_out}. Its meaning: {self.description}.",
            details={"parameter": place},
        )

    def _default_numbers(self) -> list[float] | None:
        if not isinstance(self.default, tuple):
            return None
        return [float(each) for each in self.default]

    def _check(
        self, params: Parameters, values: Sequence[float], shown: object
    ) -> None:
        for value in values:
            too_small = value < self.minimum or (
                self.excludes_minimum and value == self.minimum
            )
            if too_small or value > self.maximum:
                self.refuse(params, shown, self.allowed())


# One function per type; it takes the name, the description, and default and unit if
# there are any.
declare_boolean = partial(DeclaredParameter, ParameterType.BOOLEAN)
declare_mappings = partial(DeclaredParameter, ParameterType.MAPPINGS)
declare_number = partial(DeclaredParameter, ParameterType.NUMBER)
declare_numbers = partial(DeclaredParameter, ParameterType.NUMBERS)
declare_string = partial(DeclaredParameter, ParameterType.STRING)
declare_strings = partial(DeclaredParameter, ParameterType.STRINGS)
