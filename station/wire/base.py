"""The bases of all wire models, and the numbers and names they are made of."""

from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, JsonValue

MAX_DEPTH = 32

ControllerName = Annotated[
    str, Field(min_length=1, max_length=128, pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.-]*$")
]
"""A name that is also one segment of a URL."""

Measured = float | None
"""A number as it was measured or computed; null where there is no finite value."""


class ResponseModel(BaseModel):
    """What the station answers. Unknown keys are ignored: a newer station may add."""

    model_config = ConfigDict(
        strict=True, extra="ignore", frozen=True, allow_inf_nan=False
    )


class RequestModel(BaseModel):
    """What the station is asked. Unknown keys, `"600"`, `true` and NaN are refused."""

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
