"""A loaded controller: its claims, the commands it may write, its faults and times."""

import math
import threading
from dataclasses import dataclass

from station.core.controller import ControllerBase, ControllerState
from station.core.interfaces.interface_manager import interface_type_name
from station.core.interfaces.resource_manager import HardwareResourceManager
from station.core.robot_hw import ControllerInfo, InterfaceResources, RobotHW
from station.core.statistics import DurationRing, Percentiles


@dataclass(frozen=True, slots=True)
class ControllerStatus:
    """A controller as `controller_manager_msgs/ControllerState` has it, and more.

    Attributes:
        name: Name under which it is loaded.
        type: Its type as the parameters have it.
        state: Where it is in its life.
        claimed_resources: What it claims, one entry per hardware interface (CM-85).
        fault: Why it was stopped by the manager; empty if it was not.
        traceback: Traceback that belongs to `fault`; empty if there was none.
        fallback: Names of the controllers that take over when it fails.
        time: How long its update takes [s].
    """

    name: str
    type: str
    state: ControllerState
    claimed_resources: tuple[InterfaceResources, ...]
    fault: str
    traceback: str
    fallback: tuple[str, ...]
    time: Percentiles


@dataclass(frozen=True, slots=True)
class ControllerStatistics:
    """A controller as `controller_manager_msgs/ControllerStatistics` has it.

    Attributes:
        name: Name under which it is loaded.
        type: Its type.
        timestamp: Station time of the last cycle [s].
        running: Whether it runs.
        max_time: Longest update [s].
        mean_time: Mean duration of an update [s].
        variance_time: Variance of the durations [s^2].
        num_control_loop_overruns: Updates that took longer than the cycle's period.
        time_last_control_loop_overrun: Station time of the last one [s].
        time: Percentiles of the durations [s]; its `count` is the number of updates.
    """

    name: str
    type: str
    timestamp: float
    running: bool
    max_time: float
    mean_time: float
    variance_time: float
    num_control_loop_overruns: int
    time_last_control_loop_overrun: float
    time: Percentiles


class CommandGuard:
    """Watches the commands of one claimed resource.

    Args:
        interface: The interface through which it is claimed.
        name: Name of the resource.
        slots: Where its commands are, as (storage, index).
    """

    def __init__(
        self,
        interface: HardwareResourceManager,  # type: ignore[type-arg]  # any handle
        name: str,
        slots: list[tuple[list[float], int]],
    ) -> None:
        self.interface = interface
        self.name = name
        self.slots = slots
        self._last = [0.0 for _ in slots]
        self._rest = self._last

    def write_rest(self) -> None:
        """Command the resource to rest where it is."""
        values = self.interface.rest_commands(self.name)
        for (storage, index), value in zip(self.slots, values, strict=True):
            storage[index] = value

    def remember(self) -> None:
        """Take rest and the present commands as what a jump is measured from."""
        self._rest = self.interface.rest_commands(self.name)
        self._last = [storage[index] for storage, index in self.slots]

    def jump(self) -> float:
        """Return the largest step of a command, in its unit."""
        return max(self._steps(), default=0.0)

    def excess(self) -> tuple[float, float]:
        """Return the first step that is too large and its limit; zeros if none is."""
        limits = self.interface.start_jump_limits(self.name)
        for step, limit in zip(self._steps(), limits, strict=True):
            if not step <= limit:
                return step, limit
        return 0.0, 0.0

    def _steps(self) -> list[float]:
        """Return how far the commands are from rest or the last ones, the nearer."""
        steps: list[float] = []
        for position, (storage, index) in enumerate(self.slots):
            command = storage[index]
            from_last = abs(command - self._last[position])
            steps.append(min(from_last, abs(command - self._rest[position])))
        return steps

    def bad_command(self) -> str:
        """Return the first command that is no finite number as text; empty if none."""
        for storage, index in self.slots:
            value: object = storage[index]
            if not isinstance(value, (int, float)) or not math.isfinite(value):
                return repr(value)
        return ""


class LoadedController:
    """What the manager keeps for each loaded controller.

    Attributes:
        controller: The controller.
        info: What the hardware is told about it.
        guards: One per claimed resource that takes commands.
        pieces: The same commands as few slices, for a cheap look every cycle.
        fallback: Names of the controllers that take over when it fails.
        may_jump: Its first command may be anything (`allow_start_jump: true`).
        fault: Why the manager stopped it; empty if it did not.
        traceback: The traceback of that; empty if there was none.
        fresh: Started, and not updated yet.
        ownership: Held while somebody starts or unloads it; never waited for.
        durations: Durations of its updates [s].
    """

    def __init__(
        self,
        controller: ControllerBase,
        info: ControllerInfo,
        guards: list[CommandGuard],
        fallback: tuple[str, ...],
        *,
        may_jump: bool,
    ) -> None:
        self.controller = controller
        self.info = info
        self.guards = guards
        self.pieces = _pieces([slot for guard in guards for slot in guard.slots])
        self.fallback = fallback
        self.may_jump = may_jump
        self.fault = ""
        self.traceback = ""
        self.fresh = False
        self.ownership = threading.Lock()
        self.durations = DurationRing(1024)
        self.total = 0.0
        self.squares = 0.0
        self.overruns = 0
        self.last_overrun = 0.0

    def account(self, duration: float) -> None:
        """Note how long an update took [s]."""
        self.durations.add(duration)
        self.total += duration
        self.squares += duration * duration

    def reset_statistics(self) -> None:
        """Start the statistics anew; control thread or between cycles."""
        self.durations.reset()
        self.total = self.squares = 0.0
        self.overruns = 0
        self.last_overrun = 0.0

    def is_finite(self) -> bool:
        """Say whether every command is a finite number; cheap."""
        for storage, piece in self.pieces:
            total = sum(storage[piece])
            if total - total != 0.0:  # an overflow of the sum is no bad command
                return not self.bad_command()
        return True

    def bad_command(self) -> str:
        """Return which command is no finite number; empty if all are."""
        for guard in self.guards:
            value = guard.bad_command()
            if value:
                return f"command {value} for '{guard.name}'"
        return ""

    def write_rest(self) -> None:
        """Command everything it claims to rest where it is."""
        for guard in self.guards:
            guard.write_rest()

    def jumps(self) -> dict[str, float]:
        """Return how far its commands are from before it was started, by resource."""
        return {guard.name: guard.jump() for guard in self.guards}

    def excessive_jump(self) -> str:
        """Return which command is too far from the one before; empty if none is."""
        if self.may_jump:
            return ""
        for guard in self.guards:
            step, limit = guard.excess()
            if step > 0.0:
                return (
                    f"its first command for '{guard.name}' jumps by {step:.6g}; at "
                    f"most {limit:.6g} is allowed"
                )
        return ""

    def status(self) -> ControllerStatus:
        """Return its status. Any thread."""
        return ControllerStatus(
            self.info.name,
            self.info.type,
            self.controller.state,
            self.info.claimed_resources,
            self.fault,
            self.traceback,
            self.fallback,
            self.durations.percentiles(),
        )

    def statistics(self, time: float) -> ControllerStatistics:
        """Return its statistics at station time `time` [s]. Any thread."""
        percentiles = self.durations.percentiles()
        count = max(percentiles.count, 1)
        mean = self.total / count
        return ControllerStatistics(
            self.info.name,
            self.info.type,
            time,
            self.controller.is_running(),
            percentiles.max,
            mean,
            max(self.squares / count - mean * mean, 0.0),
            self.overruns,
            self.last_overrun,
            percentiles,
        )


def find_guards(
    hw: RobotHW, claims: tuple[InterfaceResources, ...]
) -> list[CommandGuard]:
    """Return a guard for every claimed resource that takes commands.

    Args:
        hw: The robot.
        claims: What a controller claims.
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
                    CommandGuard(interface.origin(handle.name), handle.name, slots)
                )
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


def _pieces(slots: list[tuple[list[float], int]]) -> list[tuple[list[float], slice]]:
    """Return as few (storage, slice) as cover `slots`."""
    pieces: list[tuple[list[float], slice]] = []
    for storage, index in slots:
        if pieces and pieces[-1][0] is storage and pieces[-1][1].stop == index:
            pieces[-1] = (storage, slice(pieces[-1][1].start, index + 1))
        else:
            pieces.append((storage, slice(index, index + 1)))
    return pieces
