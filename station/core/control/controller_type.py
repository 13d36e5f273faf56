"""The description of a controller type, available before loading one."""

from dataclasses import dataclass

from station.core.declared_parameter import DeclaredParameter


@dataclass(frozen=True, slots=True)
class ControllerType:
    """A type that can be loaded, and the parameters that it declares.

    Attributes:
        type: The type, usually `package/Class`.
        base_class: Name of the class of plugins that it belongs to.
        description: First line of the docstring of its class, or "".
        parameters: The parameters of every controller, and those that it declares.
        error: Why its class cannot be imported; None when it can.
    """

    type: str
    base_class: str
    description: str = ""
    parameters: tuple[DeclaredParameter, ...] = ()
    error: str | None = None
