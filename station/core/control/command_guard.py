"""The commands of one resource: checked, remembered, compared, and put to rest."""

import math
from collections.abc import Collection
from numbers import Real

from station.core.errors import CONTAINED
from station.core.hardware.interfaces.joint import ActuatorCommandInterface
from station.core.hardware.interfaces.resource_manager import (
    HardwareResourceManager,
    interface_type_name,
)
from station.core.hardware.robot_hw import InterfaceResources, RobotHW
from station.core.hardware.slots import Slot

MAX_TEXT = 60
"""Longest text of a refused command in a message [characters]."""


class CommandGuard:
    """Checks, remembers and rests the commands of one resource.

    Args:
        interface: The robot's own interface through which it is claimed.
        interface_name: Name of that interface in the controller's claims.
        name: Name of the resource.
        slots: Slots of the commands.
    """

    def __init__(
        self,
        interface: HardwareResourceManager,  # type: ignore[type-arg]  # any handle
        interface_name: str,
        name: str,
        slots: list[Slot],
    ) -> None:
        self.interface = interface
        self.claim = (interface_name, name)
        self.name = name
        self.slots = slots
        self._last = [0.0 for _ in slots]
        self._rest = self._last
        self._present = self._last

    def write_rest(self, slots: Collection[int] | None = None) -> None:
        """Command the resource to rest where it is.

        A sensor that reads NaN leaves the rest unknown. The command then stays as it
        is if it is a finite float, and otherwise becomes the last good command.

        Args:
            slots: Positions in `slots` that are written; None for all.
        """
        values = self.interface.rest_commands(self.name)
        for position, (storage, index) in enumerate(self.slots):
            if slots is not None and position not in slots:
                continue
            # A robot that cannot read its state has no rest command; its last good
            # command stays.
            if math.isfinite(values[position]):
                storage[index] = values[position]
            elif not _is_finite_float(storage[index]):
                storage[index] = self._last[position]

    def write_last(self) -> None:
        """Write the commands that `remember` has kept."""
        for (storage, index), value in zip(self.slots, self._last, strict=True):
            storage[index] = value

    def remember(self) -> bool:
        """Store rest, motion and commands as they are, to measure jumps from them.

        Returns:
            Whether rest is known, that is, finite.
        """
        self._rest = self.interface.rest_commands(self.name)
        self._present = self.interface.present_commands(self.name)
        self._last = [storage[index] for storage, index in self.slots]
        return all(math.isfinite(value) for value in self._rest)

    def jump(self) -> float:
        """Return the largest jump of a command, in its unit; see `_steps`."""
        return max(self._steps(), default=0.0)

    def excess(self) -> tuple[float, float]:
        """Return the first jump that is too large and its limit; zeros if none is."""
        limits = self.interface.start_jump_limits(self.name)
        for step, limit in zip(self._steps(), limits, strict=True):
            # Not `step > limit`, so that a NaN counts as too large.
            if not step <= limit:
                return step, limit
        return 0.0, 0.0

    def _steps(self) -> list[float]:
        """Return the jump of each command.

        It is the distance from the last command, or from the range between rest and the
        present motion if that range is nearer: a command in it slows the robot down.
        """
        steps: list[float] = []
        for position, (storage, index) in enumerate(self.slots):
            command = storage[index]
            # A command that continues the last one, or slows the robot down, is no
            # jump.
            from_last = abs(command - self._last[position])
            rest, present = self._rest[position], self._present[position]
            steps.append(min(from_last, _distance(command, rest, present)))
        return steps

    def describe(self, value: object) -> str:
        """Return a command of this resource in words, whatever the command is."""
        return f"{_as_text(value)} for '{self.name}'"

    def refused_command(self) -> str | None:
        """Return the first command that is not a real finite number, as text.

        A real number of another type (an integer, a NumPy float) is replaced by the
        float of the same value. None when every command is a finite float.
        """
        for storage, index in self.slots:
            value = storage[index]
            if _is_finite_float(value):
                continue
            converted = _as_finite_float(value)
            if converted is None:
                return _as_text(value)
            storage[index] = converted
        return None


def _distance(command: float, rest: float, present: float) -> float:
    """Return the distance of a command from the range between rest and `present`."""
    # A robot without a present value of this kind, e.g. an effort, is compared with
    # rest only.
    if not math.isfinite(present):
        return abs(command - rest)
    low, high = min(rest, present), max(rest, present)
    return max(low - command, command - high, 0.0)


def _is_finite_float(value: object) -> bool:
    """Return whether a command is a float, of exactly that type, and finite."""
    # inf - inf and NaN - NaN are NaN, so one comparison finds both.
    return type(value) is float and value - value == 0.0


def _as_finite_float(value: object) -> float | None:
    """Return a real number as a finite float; None for anything else.

    Complex numbers, texts and decimals are not converted: a control law that computes
    one of them has an error, and the nearest float would hide that error.
    """
    if not isinstance(value, Real):
        return None
    try:
        converted = float(value)
    except CONTAINED:  # 10**400 overflows, and a user's own number may raise anything
        return None
    return converted if math.isfinite(converted) else None


def _as_text(value: object) -> str:
    """Return a command as a short text, whatever it is."""
    try:
        text = repr(value)
    except CONTAINED:  # e.g. an integer with more digits than Python prints
        text = f"of type {type(value).__name__}"
    return text if len(text) <= MAX_TEXT else f"{text[:MAX_TEXT]}..."


def find_guards(
    hw: RobotHW, claims: tuple[InterfaceResources, ...]
) -> list[CommandGuard]:
    """Return a guard for every claimed resource that takes commands.

    Args:
        hw: The robot.
        claims: Claims of a controller.
    """
    guards: list[CommandGuard] = []
    for claim in claims:
        interface = _find_interface(hw, claim.hardware_interface)
        if interface is None:
            continue
        for handle in interface.handles():
            slots = handle.command_slots()
            if slots and handle.name in claim.resources:
                guards.append(
                    CommandGuard(
                        interface.origin(handle.name),
                        claim.hardware_interface,
                        handle.name,
                        slots,
                    )
                )
    return guards


def all_guards(hw: RobotHW) -> list[CommandGuard]:
    """Return a guard for every resource of the robot that takes commands.

    Actuators have none: the robot's own transmissions write their commands.

    Args:
        hw: The robot.
    """
    guards: list[CommandGuard] = []
    for interface_type in hw.interface_types():
        interface = hw.get(interface_type)
        # Transmissions write these commands from those of joints, which have guards.
        if isinstance(interface, ActuatorCommandInterface):
            continue
        if isinstance(interface, HardwareResourceManager):
            name = interface_type_name(interface_type)
            resources = tuple(interface.get_names())
            guards += find_guards(hw, (InterfaceResources(name, resources),))
    return guards


def _find_interface(
    hw: RobotHW,
    name: str,
) -> HardwareResourceManager | None:  # type: ignore[type-arg]  # any handle
    for interface_type in hw.interface_types():
        if interface_type_name(interface_type) == name:
            interface = hw.get(interface_type)
            return interface if isinstance(interface, HardwareResourceManager) else None
    return None
