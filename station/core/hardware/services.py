"""Services: operations of a robot that are not commands of controllers.

A service is a method of a `RobotServices` handle, declared once with `@service`. The
method's name, parameters and docstring are all that the API, its documentation, the
clients and the command line need.
"""

import inspect
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import Any, ClassVar, TypeVar

from station.core.hardware.interfaces.resource_manager import (
    HardwareResourceManager,
    InterfaceManager,
    ResourceHandle,
    ResourceManager,
)

MethodT = TypeVar("MethodT", bound=Callable[..., Any])
_DECLARED = "__service__"
_SECTIONS = ("Args:", "Returns:", "Raises:")


class ServiceKind(Enum):
    """The effect of calling a service."""

    QUERY = "query"
    """The service answers a question and changes nothing; it has no parameters."""
    SETTING = "setting"
    """The service sets a value; a second call with the same value changes nothing."""
    ACTION = "action"
    """The service acts; every call acts again."""


@dataclass(frozen=True, slots=True)
class Service:
    """A declared service.

    Attributes:
        name: Name of the method.
        kind: Effect of a call.
        moves: Whether a call can move the robot and is refused while the station is
            stopped.
        description: The method's docstring without its sections.
        parameters: Signature of each parameter by name, with evaluated annotations.
        returns: Annotation of the returned value; None for a method without value.
    """

    name: str
    kind: ServiceKind
    moves: bool
    description: str
    parameters: dict[str, inspect.Parameter]
    returns: Any

    @property
    def path(self) -> str:
        """Name in paths and on the command line: `ee_frame` for `set_EE_frame`."""
        return self.name.removeprefix("set_").lower()


def service(
    kind: ServiceKind = ServiceKind.ACTION, *, moves: bool = False
) -> Callable[[MethodT], MethodT]:
    """Declare a method of a `RobotServices` class as a service.

    The method runs in the control thread between two cycles: it must be short and must
    not wait. To refuse, it raises an error of `station.core.errors` before it has
    changed anything.
    Parameters and the returned value have types of JSON: numbers, text, truth values,
    None, lists and dictionaries of these.

    Args:
        kind: Effect of a call.
        moves: Whether a call can move the robot.
    """

    def declare(method: MethodT) -> MethodT:
        setattr(method, _DECLARED, (kind, moves))
        return method

    return declare


class RobotServices(ResourceHandle):
    """Services of one robot, under the robot's name.

    A robot registers it in a `RobotServicesInterface`. If a class overrides a declared
    method, the method stays a service.
    """

    @classmethod
    def services(cls) -> dict[str, Service]:
        """Return the declared services by name."""
        found: dict[str, Service] = {}
        # Base classes first, so that a class replaces a service of its base.
        for kind in reversed(cls.__mro__):
            for name, member in vars(kind).items():
                if hasattr(member, _DECLARED):
                    found[name] = _describe(name, member)
        return found


class RobotServicesInterface(HardwareResourceManager[RobotServices]):
    """Services of robots by name."""

    type_name: ClassVar[str] = "station::RobotServicesInterface"


def find_services(robot: InterfaceManager) -> list[RobotServices]:
    """Return the services in all interfaces of a `RobotHW`."""
    interfaces = (robot.get(kind) for kind in robot.interface_types())
    return [
        handle
        for interface in interfaces
        if isinstance(interface, ResourceManager)
        for handle in interface.handles()
        if isinstance(handle, RobotServices)
    ]


class InterruptibleServices(RobotServices, ABC):
    """Services whose motions end when a stop, a reset or a recovery voids commands."""

    @abstractmethod
    def interrupt(self, reason: str) -> None:
        """End a motion that is under way; control thread only.

        Args:
            reason: Why it ends, in one sentence.
        """


class RecoverableRobot(RobotServices, ABC):
    """Services of a robot whose errors stop it until it is recovered."""

    @abstractmethod
    def remedy(self) -> str | None:
        """Return the step needed before the robot can move; None if there is none."""

    @abstractmethod
    def is_recovering(self) -> bool:
        """Return whether a recovery is under way. Any thread."""

    @abstractmethod
    def check_recovery(self) -> None:
        """Refuse if the robot cannot recover now; a robot without errors can.

        Raises:
            ArmCommandError: The robot cannot recover, e.g. because the user stop is
                pressed.
        """

    @abstractmethod
    def error_recovery(self) -> bool:
        """Clear the errors; nothing moves by itself.

        Returns:
            Whether there was an error.

        Raises:
            ArmCommandError: The robot cannot recover now.
        """


def _describe(name: str, method: Callable[..., Any]) -> Service:
    kind, moves = getattr(method, _DECLARED)
    # The API builds models from the types; annotations may be strings.
    signature = inspect.signature(method, eval_str=True)
    parameters = dict(signature.parameters)
    del parameters[next(iter(parameters))]  # self
    if kind is ServiceKind.QUERY and parameters:
        raise TypeError(
            f"Service '{name}' is a query and has parameters. Declare it as an action."
        )
    lines = inspect.cleandoc(method.__doc__ or "").splitlines()
    ends = [lines.index(section) for section in _SECTIONS if section in lines]
    description = "\n".join(lines[: min(ends, default=len(lines))]).strip()
    return Service(
        name, kind, moves, description, parameters, signature.return_annotation
    )
