"""Sources of a recording that are sampled in the cycles, besides the snapshots."""

from abc import ABC, abstractmethod
from array import array
from collections.abc import Callable, Iterator
from typing import Generic, TypeVar

from typing_extensions import override

from station.core.facade.station import Station
from station.core.franka.franka_interfaces import (
    FrankaStateHandle,
    FrankaStateInterface,
)
from station.core.franka.franka_robot_state import PackedState
from station.core.hardware.interfaces import (
    EffortJointInterface,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.interfaces.joint import JointCommandInterface
from station.core.hardware.interfaces.joint_group import JointGroup
from station.core.loop.cycle_tap import CycleTap
from station.records.cycle_messages import CycleMessages, Message
from station.reports import Clearance

SampleT = TypeVar("SampleT")
_INTERFACES: dict[str, type[JointCommandInterface]] = {
    "position": PositionJointInterface,
    "velocity": VelocityJointInterface,
    "effort": EffortJointInterface,
}


class CycleSource(ABC, Generic[SampleT]):
    """A channel whose messages are sampled in every cycle while it is open.

    Args:
        station: The station.
    """

    def __init__(self, station: Station) -> None:
        self._tap: CycleTap[SampleT] = CycleTap(station.loop, self.sample)
        self._cycle = 0

    @abstractmethod
    def sample(self) -> SampleT:
        """Return the sample of a cycle; called by the control thread, must not wait."""

    @abstractmethod
    def message(
        self, encoder: CycleMessages, time: float, sample: SampleT
    ) -> Iterator[Message]:
        """Yield the messages of a cycle.

        Args:
            encoder: Makes messages.
            time: Station time of the cycle [s].
            sample: Result of `sample` in that cycle.
        """

    def open(self) -> None:
        """Sample from the next cycle on."""
        self._tap.open()

    def begin(self, cycle: int) -> None:
        """Drop the samples of cycles before this one.

        Args:
            cycle: Number of the first cycle.
        """
        self._cycle = cycle - 1

    @property
    def newest(self) -> int:
        """Number of the last cycle that was sampled."""
        return self._tap.newest_cycle()

    def close(self) -> None:
        """Stop sampling."""
        self._tap.close()

    @property
    def failure(self) -> str | None:
        """Return the reason why sampling has ended; None while it goes on."""
        return self._tap.failure

    def take(
        self,
        encoder: CycleMessages,
        log: Callable[[Message, float], None],
        until: int,
    ) -> int:
        """Pass on the messages of the cycles since the last call.

        Args:
            encoder: Makes messages.
            log: Takes each message, and its station time [s].
            until: Number of the last cycle to pass on; later ones wait for the next
                call.

        Returns:
            How many cycles were lost.
        """
        taken, lost = self._tap.read_since(self._cycle)
        if taken:
            # Begin after the lost cycles, so that they are reported only once.
            self._cycle = taken[0].cycle - 1
        for one in taken:
            # Later samples wait for the row of their cycle, so that messages stay in
            # order.
            if one.cycle > until:
                break
            for message in self.message(encoder, one.stamp, one.sample):
                log(message, one.stamp)
            self._cycle = one.cycle
        return lost


class CommandSource(CycleSource[list[bytes]]):
    """The joint commands after `write`, with limits applied, as they went to the robot.

    The commands of a controller before the limits are the `output` of its own channel.
    The command after the filters and rate limits of an arm is in the state of the arm.
    """

    def __init__(self, station: Station) -> None:
        self._groups: list[tuple[str, tuple[str, ...], JointGroup]] = []
        for quantity, kind in _INTERFACES.items():
            interface = station.loop.hw.get(kind)
            if interface is not None and interface.get_names():
                group = JointGroup(interface.handles())
                self._groups.append((quantity, tuple(group.names), group))
        super().__init__(station)

    @override
    def sample(self) -> list[bytes]:
        return [_memory(group) for _, _, group in self._groups]

    @override
    def message(
        self, encoder: CycleMessages, time: float, sample: list[bytes]
    ) -> Iterator[Message]:
        for (quantity, names, _), commands in zip(self._groups, sample, strict=True):
            yield encoder.of_commands(quantity, time, names, commands)


class ArmSource(CycleSource[PackedState]):
    """The whole state of an arm.

    Args:
        station: The station.
        handle: Reads the arm.
    """

    def __init__(self, station: Station, handle: FrankaStateHandle) -> None:
        self._handle = handle
        self._arm_id = handle.name.removesuffix("_robot")
        super().__init__(station)

    @override
    def sample(self) -> PackedState:
        return self._handle.get_robot_state().packed()

    @override
    def message(
        self, encoder: CycleMessages, time: float, sample: PackedState
    ) -> Iterator[Message]:
        yield encoder.of_arm(self._arm_id, time, sample)


class ClearanceSource(CycleSource[list[Clearance]]):
    """The nearest pair of each arm that keeps clear of objects."""

    def __init__(self, station: Station) -> None:
        self._surroundings = station.surroundings
        super().__init__(station)

    @override
    def sample(self) -> list[Clearance]:
        return self._surroundings.clearances()

    @override
    def message(
        self, encoder: CycleMessages, time: float, sample: list[Clearance]
    ) -> Iterator[Message]:
        for pair in sample:
            yield encoder.of_clearance(time, pair)


Source = CommandSource | ArmSource | ClearanceSource


def sources_of(station: Station) -> list[Source]:
    """Return all sources of a station."""
    arms = station.loop.hw.get(FrankaStateInterface)
    handles = [] if arms is None else arms.handles()
    found: list[Source] = [CommandSource(station)]
    found += [ArmSource(station, handle) for handle in handles]
    if station.loop.hw.guards():
        found.append(ClearanceSource(station))
    return found


def _memory(group: JointGroup) -> bytes:
    if group.commands is not None:
        # Commands that lie side by side are copied at once.
        return group.commands.tobytes()
    return array("d", group.get_commands()).tobytes()
