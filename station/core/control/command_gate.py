"""The gate between the writers of commands and the robot.

Before every `write` each command of the robot is a real finite float that its one owner
has written, or the rest command of a resource without an owner:

1. After every call of a controller its own commands are checked and copied
   (`ControllerCommands.refused`), so that a bad value is charged to that call.
2. At the end of the cycle `keep_commands` writes all of them anew: rest for resources
   without an owner, and, if several controllers run, the accepted commands of each
   owner. So nothing else reaches the robot.
3. Around every call of a controller in a switch, and around `do_switch`, the commands
   of the others are remembered and put back (`CommandGate.remember`, `put_back`).
4. Before it writes, `keep_commands` compares one block of commands with its copy,
   another block in every cycle. After a difference the gate traces for some cycles: it
   compares all blocks after every call of a controller, and the controller that writes
   commands without owning them is stopped.

The gate does not check ranges: `RobotHW.write` enforces the joint limits, which depend
on the measured state and on the period.
"""

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import cython

from station.core.control.command_guard import all_guards
from station.core.control.controller import ControllerState
from station.core.errors import CONTAINED
from station.core.hardware.robot_hw import RobotHW
from station.core.hardware.slots import Slot, SlotRun, in_memory_order, side_by_side
from station.memory.doubles import Doubles, Storage, zeros
from station.memory.vectors import are_finite, copy_into, differ

if TYPE_CHECKING:
    from station.core.control.loaded_controller import LoadedController

_RUNNING = ControllerState.RUNNING
# Compared by type: True and 0j pass comparisons with floats, and a robot must not get
# them.
_FLOAT = {float}

TRACED_CYCLES = 1000
"""Time for which the gate traces the writer of a command without a claim [cycles]."""

SlotId = tuple[int, int]
"""Identity of a storage and an index into it."""

Remembered = list[tuple[Storage, int, float]]
"""Commands as (storage, index, value)."""


class CommandBlock:
    """Commands that lie side by side, and a copy of them.

    Args:
        slots: Slot of each command.
        values: The copy, shape (n,), changed in place.
    """

    def __init__(self, slots: Sequence[Slot], values: Storage) -> None:
        self.slots = slots
        self.values = values

    def copy_commands(self) -> bool:
        """Copy the commands; return whether all are known to be finite floats."""
        raise NotImplementedError

    def has_changed(self) -> bool:
        """Return whether a command differs from its copy."""
        raise NotImplementedError

    def write_copy(self) -> None:
        """Write the copied commands."""
        raise NotImplementedError


class DoublesBlock(CommandBlock):
    """Commands in memory of doubles.

    Args:
        memory: The commands, shape (n,).
        slots: Slot of each command.
    """

    def __init__(self, memory: Doubles, slots: Sequence[Slot] = ()) -> None:
        self.memory = memory
        self.size = len(memory)
        self.copy = zeros(self.size)
        super().__init__(slots, self.copy)
        self.copy_commands()

    def copy_commands(self) -> bool:
        """Copy the commands; return whether all are known to be finite."""
        if cython.compiled:
            copy_into(self.copy, 0, self.memory, self.size)
        else:
            self.copy[:] = self.memory
        return are_finite(self.copy, self.size)

    def has_changed(self) -> bool:
        """Return whether a command differs from its copy."""
        if cython.compiled:
            return differ(self.memory, self.copy, self.size)
        return self.memory != self.copy

    def write_copy(self) -> None:
        """Write the copied commands."""
        if cython.compiled:
            copy_into(self.memory, 0, self.copy, self.size)
        else:
            self.memory[:] = self.copy


class ListBlock(CommandBlock):
    """Commands in a list, which may hold any object.

    Args:
        storage: The list.
        place: Range of the commands in the list.
        slots: Slot of each command.
    """

    def __init__(
        self, storage: list[float], place: slice, slots: Sequence[Slot]
    ) -> None:
        self.storage = storage
        self.place = place
        self.copy = storage[place]
        super().__init__(slots, self.copy)

    def copy_commands(self) -> bool:
        """Copy the commands; return whether all are known to be finite floats."""
        copy = self.copy
        copy[:] = self.storage[self.place]
        # Types are checked first: the sum of a complex number or of a decimal raises,
        # or passes every comparison with a float. A sum that overflows may come from
        # good commands; after False the caller checks each of them.
        return set(map(type, copy)) == _FLOAT and not (total := sum(copy)) - total

    def has_changed(self) -> bool:
        """Return whether a command differs from its copy."""
        try:
            return self.storage[self.place] != self.copy
        except CONTAINED:  # e.g. an array: its comparison has no truth value
            return True

    def write_copy(self) -> None:
        """Write the copied commands."""
        self.storage[self.place] = self.copy


def make_blocks(slots: Iterable[Slot]) -> list[CommandBlock]:
    """Return the commands in some slots as blocks with copies of the present values."""
    return [_make_block(run) for run in side_by_side(slots)]


def _make_block(run: SlotRun) -> CommandBlock:
    if isinstance(run.storage, list):
        return ListBlock(run.storage, slice(run.begin, run.end), run.slots)
    return DoublesBlock(run.storage[run.begin : run.end], run.slots)


class CommandGate:
    """Keeps the commands of a robot with their owners. Control thread only.

    Args:
        hw: The robot, initialised.

    Attributes:
        is_stale: Whether controllers have started or stopped since the owners were
            noted; set at each start and each stop.
        running: The controllers that ran when the owners were noted last, in the order
            of loading.
        traced_cycles: Number of cycles for which the gate still compares all commands
            after every call of a controller; 0 until a violation is found.
        violations: How often a command was found that its owner had not written.
        last_violation: The last violation as a sentence; None if there was none.
    """

    def __init__(self, hw: RobotHW) -> None:
        self.is_stale = True
        self.traced_cycles = 0
        self.running: tuple[LoadedController, ...] = ()
        self.violations = 0
        self.last_violation: str | None = None
        self.guards = all_guards(hw)
        # Commands without an owner, at rest; and all commands that are written anew.
        self.resting: list[CommandBlock] = []
        self.kept: list[CommandBlock] = []
        self.next_compared = 0
        self.owned_names: set[str] = set()
        self.names: dict[SlotId, str] = {
            (id(storage), index): guard.name
            for guard in self.guards
            for storage, index in guard.slots
        }
        commands = in_memory_order(slot for one in self.guards for slot in one.slots)
        self.slots: dict[SlotId, Slot] = {
            (id(storage), index): (storage, index) for storage, index in commands
        }

    def remember(self, one: "LoadedController") -> Remembered:
        """Return every command of the robot that `one` does not own.

        Used around a call of `one` during which no other controller writes commands.
        """
        own = {(id(storage), index) for storage, index in one.commands.slots}
        return [
            (storage, index, storage[index])
            for slot, (storage, index) in self.slots.items()
            if slot not in own
        ]

    def put_back(self, remembered: Remembered) -> str | None:
        """Undo all writes to commands since they were remembered.

        Returns:
            The first resource whose command had changed; None if none had.
        """
        changed: str | None = None
        # Do not stop at the first: a callback may have written several commands.
        for storage, index, value in remembered:
            now = storage[index]
            # By type, because 0j equals 0.0; by identity, for a NaN that was there.
            if now is value or (type(now) is float and now == value):
                continue
            storage[index] = value
            changed = changed or self.names[id(storage), index]
        return changed

    def forget_rest(self) -> None:
        """Make `note_owners` renew rest commands of resources without an owner.

        Called when a simulated world was put into another state.
        """
        self.resting = []
        self._keep([])
        self.is_stale = True

    def keep_commands(self) -> None:
        """Write every command anew, unless owners have changed in this cycle."""
        if self.traced_cycles:
            self.traced_cycles -= 1
            self.restore_commands()
            return
        # Only one block is compared in a cycle: comparing all of them costs more than
        # writing them, and a stray write is overwritten below in any case.
        kept, place = self.kept, self.next_compared
        size = len(kept)
        if place < size:
            block = kept[place]
            if block.has_changed():
                self._report(block)
        self.next_compared = place + 1 if place + 1 < size else 0
        # A block that equals its copy is written, too: 0j equals 0.0 and is no float.
        for each in kept:
            each.write_copy()

    def restore_commands(self) -> None:
        """Compare all commands with the accepted ones, and write the accepted ones.

        Called before a switch, because it changes the owners, and at the beginning of a
        traced cycle, so that a write between two cycles is not charged to the
        controller that is called next. If owners have changed in this cycle already,
        nothing happens, because `note_owners` then looks at all commands.
        """
        if self.is_stale:
            return
        for block in self.kept:
            if block.has_changed():
                self._report(block)
            block.write_copy()

    def find_intrusion(
        self, one: "LoadedController", loaded: "Iterable[LoadedController]"
    ) -> str | None:
        """Return a command that `one` does not own and has written in a call.

        Called after every update while the gate traces. Foreign writes are put back.

        Args:
            one: The controller that was called.
            loaded: All controllers; those before `one` have been updated already.
        """
        # The commands of the controllers before `one` were copied after their updates,
        # so `one` has made any difference. Later ones have not been copied yet.
        for other in loaded:
            if other is one:
                break
            if (
                other.controller.state is _RUNNING
                and not other.commands.is_as_written()
            ):
                other.commands.write_again()
                return f"the commands of '{other.info.name}'"
        for block in self.resting:
            if block.has_changed():
                name = self._changed(block)
                block.write_copy()
                return f"the command of '{name}'"
        return None

    def note_owners(self, loaded: "Iterable[LoadedController]") -> None:
        """Find the commands without an owner, let them rest, and write all anew.

        A resource that had no owner before keeps its rest command: a new one would be
        the measured position, and a joint under load would creep a little at every
        switch. A resource that had an owner has moved meanwhile, so all of its commands
        get new rest values, those of other interfaces as well.
        """
        if self.traced_cycles:
            self.traced_cycles -= 1
        owned = _count_owners(loaded)
        before = {
            (id(storage), index): value
            for block in self.resting
            for (storage, index), value in zip(block.slots, block.values, strict=True)
        }
        for guard in self.guards:
            begun = []
            for position, (storage, index) in enumerate(guard.slots):
                slot = (id(storage), index)
                if slot in owned:
                    continue
                # Keep the old rest: a new one would be the present position, and the
                # joint would creep at each change of owners.
                if slot in before and guard.name not in self.owned_names:
                    storage[index] = before[slot]
                else:
                    begun.append(position)
            if begun:
                guard.write_rest(begun)
        free = [slot for name, slot in self.slots.items() if name not in owned]
        self.resting = make_blocks(free)
        self.running = tuple(one for one in loaded if one.controller.state is _RUNNING)
        running = self.running
        self.owned_names = {g.name for one in running for g in one.commands.guards}
        owners = [one for one in running if not one.commands.is_shared]
        for one in owners:
            one.commands.write_again()
        # The commands of a controller that runs without others stay as it wrote them.
        beside = owners if len(running) > 1 else []
        owned_blocks = [block for one in beside for block in one.commands.blocks]
        self._keep([*self.resting, *owned_blocks])
        self.is_stale = False

    def _keep(self, blocks: list[CommandBlock]) -> None:
        self.kept = blocks
        self.next_compared = 0

    def _changed(self, block: CommandBlock) -> str:
        for (storage, index), value in zip(block.slots, block.values, strict=True):
            # By type, because 0j equals 0.0.
            now = storage[index]
            if not (type(now) is float and now == value):
                return self.names[id(storage), index]
        return "an unknown resource"

    def _report(self, block: CommandBlock) -> None:
        """Note a write to the commands of another owner, and trace the writer."""
        self.violations += 1
        self.last_violation = (
            "Somebody without a claim has written the command of "
            f"'{self._changed(block)}'."
        )
        self.traced_cycles = TRACED_CYCLES


def _count_owners(loaded: "Iterable[LoadedController]") -> Counter[SlotId]:
    """Count the owners of every command; mark the controllers that share commands."""
    running = [one for one in loaded if one.controller.state is _RUNNING]
    owned = Counter(
        (id(storage), index) for one in running for storage, index in one.commands.slots
    )
    for one in running:
        one.commands.is_shared = any(
            owned[id(storage), index] > 1 for storage, index in one.commands.slots
        )
    return owned
