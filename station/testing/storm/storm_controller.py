"""A controller that moves a little, and misbehaves when it is told to."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from math import inf, nan
from typing import cast

from typing_extensions import override

from station.core.control.controller import ControllerBase, ControllerState
from station.core.errors import ControllerLoadError
from station.core.hardware.interfaces import (
    EffortJointInterface,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.robot_hw import InterfaceResources, RobotHW
from station.core.parameters import Parameters
from station.testing.switch_observer import CommandPlace, command_places

STORM_TYPE = "storm/Controller"
"""The type under which the storm loads its controllers."""
CALLBACKS = ("starting", "update", "stopping", "waiting", "aborting")
"""The callbacks in which a controller can misbehave."""
BAD_COMMANDS: Sequence[object] = (
    nan,
    inf,
    -inf,
    0j,
    complex(0.5, 0.0),
    10**400,
    Decimal("0.5"),
    Decimal("NaN"),
    "0.5",
    None,
    [0.0],
)
"""Commands that must never reach a robot."""
ODD_COMMANDS: Sequence[object] = (0, 1, True, 1e4, -1e4)
"""Commands that are real numbers, but of another type, or large."""
_SPEED: Mapping[str, float] = {
    EffortJointInterface.type_name: 0.1,
    PositionJointInterface.type_name: 2e-6,
    VelocityJointInterface.type_name: 1e-4,
}
"""By how much the command of an interface changes in a cycle."""
_TURN = 100
"""After so many cycles the command changes in the other direction."""


@dataclass(frozen=True, slots=True)
class Mischief:
    """A fault that a controller commits once.

    Attributes:
        callback: In which callback, one of `CALLBACKS`.
        command: What to command; None raises an error instead.
        intrudes: Command a resource of somebody else.
        place: Which command of its own, or of all, counted modulo their number.
    """

    callback: str
    command: tuple[object] | None = None
    intrudes: bool = False
    place: int = 0


class StormController(ControllerBase):
    """Claims what its parameters say and moves it to and fro by a little.

    Parameters: `interface`, the wire name of a hardware interface; `resources`, names.

    Attributes:
        mischief: What it does wrong next; None for nothing. Any thread may set it.
        mischiefs: How often it has done something wrong.
    """

    def __init__(self) -> None:
        super().__init__()
        self.mischief: Mischief | None = None
        self.mischiefs = 0
        self._places: list[CommandPlace] = []
        self._own: list[CommandPlace] = []
        self._written: list[object] = []
        self._speed = 0.0
        self._cycles = 0

    @override
    def init_request(
        self, hw: RobotHW, params: Parameters
    ) -> tuple[InterfaceResources, ...]:
        """Claim the resources.

        Args:
            hw: The robot.
            params: The parameters of the class.

        Raises:
            ControllerLoadError: The robot has none of these resources; or the parameter
                `mischief` is set.
        """
        interface = params.get_str("interface")
        resources = params.get_str_list("resources")
        if params.get_bool("mischief", default=False):
            raise ControllerLoadError("The storm lets this controller fail in init.")
        self._places = command_places(hw)
        wanted = {(interface, resource) for resource in resources}
        self._own = [place for place in self._places if place.claim in wanted]
        if {place.claim for place in self._own} != wanted:
            raise ControllerLoadError(
                f"The robot has no commands {resources} in '{interface}'.",
                remedy="Claim what it has.",
            )
        self._speed = _SPEED.get(interface, 0.0)
        self.state = ControllerState.INITIALIZED
        return (InterfaceResources(interface, tuple(sorted(resources))),)

    def find_overwritten(self) -> str | None:
        """Return a command that is not what it wrote; None if all are.

        Control thread, while it runs.
        """
        for place, value in zip(self._own, self._written, strict=False):
            now = place.storage[place.index]
            if now != value:
                return f"{place.claim} is commanded {now!r}; its owner wrote {value!r}"
        return None

    @override
    def starting(self, time: float) -> None:
        self._cycles = 0
        self._note_written()
        self._misbehave("starting")

    @override
    def update(self, time: float, period: float) -> None:
        self._cycles += 1
        step = self._speed if self._cycles // _TURN % 2 == 0 else -self._speed
        for place in self._own:
            place.storage[place.index] += step
        self._note_written()
        self._misbehave("update")

    @override
    def stopping(self, time: float) -> None:
        self._misbehave("stopping")

    @override
    def waiting(self, time: float) -> None:
        self._misbehave("waiting")

    @override
    def aborting(self, time: float) -> None:
        self._misbehave("aborting")

    def _note_written(self) -> None:
        self._written = [place.storage[place.index] for place in self._own]

    def _misbehave(self, callback: str) -> None:
        mischief = self.mischief
        if mischief is None or mischief.callback != callback:
            return
        self.mischief = None
        self.mischiefs += 1
        if mischief.command is None:
            raise RuntimeError("the storm lets this callback fail")
        places = self._places if mischief.intrudes else self._own
        place = places[mischief.place % len(places)]
        place.storage[place.index] = cast("float", mischief.command[0])
        # Several interfaces may share a command, so that an intruder may be the owner.
        is_own = place.slot in {own.slot for own in self._own}
        if is_own and callback in {"starting", "update"}:
            self._note_written()


MakeMischief = Callable[[], Mischief]
"""Returns the next mischief."""
