"""Wire models of types of controllers: what can be loaded, with which parameters."""

from typing import Annotated, Literal

from pydantic import AliasChoices, BeforeValidator, Field, JsonValue

from station.wire.base import FromEnum, Items, Measured, Reason, ResponseModel


def list_of_tuple(value: object) -> object:
    """Return `value`, or the list of the items of a tuple."""
    return list(value) if isinstance(value, tuple) else value


class DeclaredParameter(ResponseModel):
    """A parameter of a controller, as its type declares it.

    Attributes:
        name: Path below the controller's namespace, so the place in `params` of the
            load request; `/` separates namespaces, and `<joint>` stands for the name of
            each joint.
        type: What the value is: `number`, `boolean`, `string`, `numbers` and `strings`
            (lists), `number_or_numbers` (one for all, or a list with one for each),
            `mappings` (a list of objects).
        description: What it is for.
        unit: Unit of the numbers, where joints are concerned that of rotating joints;
            empty for what has no unit.
        required: Whether loading is refused when it is absent.
        default: Value when it is absent; null when there is no fixed one.
        default_text: How the default follows from the robot or other parameters; empty
            when the default is fixed or the parameter is required.
        minimum: Smallest number allowed; null for no bound.
        excludes_minimum: Whether the number must be larger than `minimum`.
        maximum: Largest number allowed; null for no bound.
        choices: The strings allowed; empty when any is.
        size: Length that a list must have; null when any is allowed.
        names: What the strings are names of: a `joint`, an `arm`, a `controller`; empty
            for other strings.
    """

    name: str
    type: Annotated[
        Literal[
            "number",
            "boolean",
            "string",
            "numbers",
            "strings",
            "number_or_numbers",
            "mappings",
        ],
        FromEnum,
    ]
    description: str
    unit: str
    required: bool = Field(validation_alias=AliasChoices("required", "is_required"))
    default: Annotated[JsonValue, BeforeValidator(list_of_tuple)] = None
    default_text: str
    minimum: Measured
    excludes_minimum: bool
    maximum: Measured
    choices: Items[str]
    size: int | None
    names: Annotated[Literal["", "joint", "arm", "controller"], FromEnum]


class ControllerType(ResponseModel):
    """A plugin that can be loaded.

    Attributes:
        type: Its type, `package/Class`.
        base_class: Class of plugins that it belongs to.
        description: What it does; empty where it does not say.
        parameters: The parameters that it declares, after those of every controller;
            a type that somebody else wrote may read more than it declares.
        error: Why its code cannot be imported; empty when it can.
    """

    type: str
    base_class: str
    description: Reason = ""
    parameters: Items[DeclaredParameter] = Field(default_factory=list)
    error: Reason = ""


class ControllerTypes(ResponseModel):
    """All plugins that can be loaded.

    Attributes:
        controller_types: The types, in the order in which they are declared.
    """

    controller_types: Items[ControllerType]
