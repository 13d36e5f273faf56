"""The bases of all wire models, and the numbers and names they are made of.

Reports of `station.reports` are sent as they are. An answer whose form on the wire
differs from the core's value is a model, which reads the attributes of the value:
`wire.ArmReport.model_validate(report)`. The types here convert values that JSON cannot
express: numbers that are not finite, members of enumerations, tuples and absent
reasons.
"""

import math
from collections.abc import Iterable
from enum import Enum
from typing import Annotated, Any, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    JsonValue,
    TypeAdapter,
)

from station.reports import Described

MAX_DEPTH = 32

ControllerName = Annotated[
    str, Field(min_length=1, max_length=128, pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.-]*$")
]
"""A name that is also one segment of a URL."""
FileName = Annotated[
    str, Field(min_length=1, max_length=100, pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.-]*$")
]
"""A name that is also one segment of a URL and the name of a file."""

ItemT = TypeVar("ItemT")
ReadT = TypeVar("ReadT")


def finite_or_none(value: object) -> object:
    """Return `value`, or None if it is a float that is not finite."""
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
"""A reason or a remedy; None in the core becomes empty text."""

FromEnum = BeforeValidator(name_of)
"""Reads the name of a member of one of the core's enumerations."""


class WireModel(Described, BaseModel):
    """A model whose docstring describes its fields in the JSON schema."""


# Readers are kept: making one takes a millisecond, reading with it microseconds.
_READERS: dict[type[object], TypeAdapter[Any]] = {}


def reader_of(kind: type[ReadT]) -> TypeAdapter[ReadT]:
    """Return pydantic's reader of a report or a wire model."""
    reader = _READERS.get(kind)
    if reader is None:
        reader = _READERS[kind] = TypeAdapter(kind)
    return reader


class ResponseModel(WireModel):
    """Base of the answers; read from JSON, or from the core by attribute.

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
    """Base of the requests; refuses unknown keys, values of another type and NaN."""

    model_config = ConfigDict(
        strict=True, extra="forbid", frozen=True, allow_inf_nan=False
    )


def check_depth(values: dict[str, JsonValue]) -> dict[str, JsonValue]:
    """Return `values` unchanged when their nesting is not too deep.

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
