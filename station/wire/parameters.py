"""Wire models of the tree of parameters, as rosparam has it."""

from typing import Annotated

from pydantic import AfterValidator, JsonValue

from station.wire.base import RequestModel, ResponseModel, check_depth


def _check_depth(value: JsonValue) -> JsonValue:
    check_depth({"value": value})
    return value


class Parameter(ResponseModel):
    """A parameter, or a namespace with all that is below it.

    Attributes:
        path: Names separated by `/`; empty for the whole tree.
        value: Its value; a namespace is an object.

    Example:
        {"path": "arm/panda_joint1/p", "value": 600.0}
    """

    path: str
    value: JsonValue


class ParameterRequest(RequestModel):
    """A new value of a parameter.

    Attributes:
        value: Any JSON, nested 32 levels deep at most; an object replaces the whole
            namespace.

    Example:
        {"value": 600.0}
    """

    value: Annotated[JsonValue, AfterValidator(_check_depth)]
