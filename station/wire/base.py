"""The bases of all wire models, and the numbers and names they are made of.

Answers are read from the core's own values by attribute, without importing them:
`wire.LoopReport.model_validate(report)`. The types here convert what JSON has no word
for: numbers that are not finite, members of enumerations, tuples and absent reasons.
"""

import inspect
import math
import re
from collections.abc import Iterable
from enum import Enum
from typing import Annotated, Any, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetJsonSchemaHandler,
    JsonValue,
)
from pydantic.json_schema import JsonSchemaValue
from typing_extensions import override

MAX_DEPTH = 32
_ATTRIBUTE = re.compile(r" {4}(\w+(?:, \w+)*): (.*)")

ControllerName = Annotated[
    str, Field(min_length=1, max_length=128, pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.-]*$")
]
"""A name that is also one segment of a URL."""

ItemT = TypeVar("ItemT")


def finite_or_none(value: object) -> object:
    """Return `value`, or None for a float that is not finite."""
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def list_of_finite(values: object) -> object:
    """Return the items of `values` with None for every float that is not finite."""
    if isinstance(values, Iterable) and not isinstance(values, str):
        return [finite_or_none(value) for value in values]
    return values


def name_of(value: object) -> object:
    """Return the name that a member of an enumeration has on the wire.

    The name is the member's value when the value is text, and otherwise the member's
    own name in lower case (libfranka numbers its modes and frames).
    """
    if isinstance(value, Enum):
        return value.value if isinstance(value.value, str) else value.name.lower()
    return value


def text_or_empty(value: object) -> object:
    """Return `value`, or empty text for None."""
    return "" if value is None else value


Measured = Annotated[float | None, BeforeValidator(finite_or_none)]
"""A number as it was measured or computed; null where there is no finite value."""

Measurements = Annotated[list[float | None], BeforeValidator(list_of_finite)]
"""Numbers as they were measured or computed; null where there is no finite value."""

Items = Annotated[list[ItemT], Field(strict=False)]
"""A JSON array; the core may have it as a tuple."""

Reason = Annotated[str, BeforeValidator(text_or_empty)]
"""A reason or a remedy; empty where there is none, which is None in the core."""

FromEnum = BeforeValidator(name_of)
"""Reads the name of a member of one of the core's enumerations."""


class WireModel(BaseModel):
    """Describes its fields in the JSON schema by the `Attributes` of its docstring."""

    @classmethod
    @override
    def __get_pydantic_json_schema__(
        cls,
        core_schema: Any,
        handler: GetJsonSchemaHandler,
    ) -> JsonSchemaValue:
        schema = handler(core_schema)
        found = handler.resolve_ref_schema(schema)
        found["description"] = described(cls.__doc__)[0]
        properties = found.get("properties", {})
        for kind in reversed(cls.__mro__):
            attributes = described(kind.__doc__)[1]
            for name, field in cls.model_fields.items():
                key = field.alias or name
                if name in attributes and key in properties:
                    properties[key]["description"] = attributes[name]
        return schema


def example(values: dict[str, JsonValue]) -> ConfigDict:
    """Return a configuration of a model with one example for its schema."""
    return ConfigDict(json_schema_extra={"examples": [values]})


def described(docstring: str | None) -> tuple[str, dict[str, str]]:
    """Return the text of a docstring, and its description of each attribute.

    Args:
        docstring: In Google's style; `a, b: Text` describes both.
    """
    text, _, section = inspect.cleandoc(docstring or "").partition("\n\nAttributes:\n")
    attributes: dict[str, str] = {}
    names: list[str] = []
    for line in section.partition("\n\n")[0].splitlines():
        begin = _ATTRIBUTE.fullmatch(line)
        if begin is not None:
            names = [name.strip() for name in begin[1].split(",")]
            attributes |= dict.fromkeys(names, begin[2])
        else:
            for name in names:
                attributes[name] += f" {line.strip()}"
    return " ".join(text.split()), attributes


class ResponseModel(WireModel):
    """Answer of the station; read from JSON, or from the core by attribute.

    Unknown keys are ignored, because a newer station may add some.
    """

    model_config = ConfigDict(
        strict=True,
        extra="ignore",
        frozen=True,
        allow_inf_nan=False,
        from_attributes=True,
    )


class RequestModel(WireModel):
    """Request to the station. Unknown keys, `"600"`, `true` and NaN are refused."""

    model_config = ConfigDict(
        strict=True, extra="forbid", frozen=True, allow_inf_nan=False
    )


def check_depth(values: dict[str, JsonValue]) -> dict[str, JsonValue]:
    """Return `values` as they are when they are not nested too deep.

    Raises:
        ValueError: The nesting is deeper than `MAX_DEPTH`.
    """
    level: list[JsonValue] = [values]
    depth = 0
    while level:
        if depth > MAX_DEPTH:
            raise ValueError(f"parameters are nested deeper than {MAX_DEPTH} levels")
        level = [child for node in level for child in _children(node)]
        depth += 1
    return values


def _children(node: JsonValue) -> list[JsonValue]:
    if isinstance(node, dict):
        return list(node.values())
    return node if isinstance(node, list) else []


ParameterValues = Annotated[dict[str, JsonValue], AfterValidator(check_depth)]
"""Nested parameters of a controller, every number finite."""
