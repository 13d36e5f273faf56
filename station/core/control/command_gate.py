"""The gate between whatever wrote a command and the robot.

Before every `write` each command of the robot is a real finite float that its one owner
has written, or the rest command of a resource that nobody owns. Four looks make sure
of it:

1. After every call of a controller its own commands are checked
   (`ControllerCommands.refused`), so that a bad value is charged to that call.
2. After all updates `check_owned` compares the commands of the running controllers with
   what they wrote: a difference means that somebody else wrote them.
3. Around every other call of a controller, and around `do_switch`, the commands of the
   others are remembered and put back (`CommandGate.remember`, `put_back`).
4. At the end of the cycle `close` compares the commands of resources without an owner
   with their rest.

The ranges of the commands are the robot's business: `RobotHW.write` enforces the joint
limits, which depend on the measured state and on the period.
"""

from collections import Counter
from collections.abc import Iterable, Iterator

from station.core.control.command_guard import all_guards, as_pieces
from station.core.control.controller import ControllerState
from station.core.control.loaded_controller import LoadedController
from station.core.faults import CONTAINED
from station.core.hardware.robot_hw import RobotHW

_RUNNING = ControllerState.RUNNING

TRACED_CYCLES = 1000
"""How long the gate looks for whoever writes commands without a claim [cycles]."""

Slot = tuple[int, int]
"""Identity of a storage and an index into it."""

Remembered = list[tuple[list[float], int, float]]
"""Commands as (storage, index, value)."""


class CommandGate:
    """Keeps the commands of a robot with their owners. Control thread only.

    Args:
        hw: The robot, initialised.

    Attributes:
        is_stale: Whether controllers have started or stopped since the owners were
            noted; set by whoever starts or stops one.
        traced_cycles: For how many cycles more the gate looks after every call for
            whoever writes commands that it does not own; 0 until a violation is found.
        violations: How often a command was found that its owner had not written.
        last_violation: The last of them as a sentence; None if there was none.
    """

    def __init__(self, hw: RobotHW) -> None:
        self.is_stale = True
        self.traced_cycles = 0
        self.violations = 0
        self.last_violation: str | None = None
        self._guards = all_guards(hw)
        # Commands that nobody owns, with their rest: whole storages, and parts of some.
        self._whole: list[tuple[list[float], list[float]]] = []
        self._parts: list[tuple[list[float], slice, list[float]]] = []
        self._names: dict[Slot, str] = {
            (id(storage), index): guard.name
            for guard in self._guards
            for storage, index in guard.slots
        }

        self._slots: dict[Slot, tuple[list[float], int]] = {
            (id(storage), index): (storage, index)
            for guard in self._guards
            for storage, index in guard.slots
        }

    def remember(self, one: LoadedController) -> Remembered:
        """Return every command of the robot that `one` does not own.

        For a call of `one` in which nobody else writes commands.
        """
        own = {(id(storage), index) for storage, index in one.commands.slots}
        return [
            (storage, index, storage[index])
            for slot, (storage, index) in self._slots.items()
            if slot not in own
        ]

    def put_back(self, remembered: Remembered) -> str | None:
        """Undo what was written to commands since they were remembered.

        Returns:
            The first resource whose command had changed; None if none had.
        """
        changed: str | None = None
        for storage, index, value in remembered:
            now = storage[index]
            # By type, because 0j equals 0.0; by identity, for a NaN of before.
            if now is value or (type(now) is float and now == value):
                continue
            storage[index] = value
            changed = changed or self._names[id(storage), index]
        return changed

    def forget_rest(self) -> None:
        """Let resources without an owner rest where they are now, at the next `close`.

        For a world that was put somewhere else.
        """
        self._whole.clear()
        self._parts.clear()
        self.is_stale = True

    def check_owned(self, loaded: Iterable[LoadedController]) -> None:
        """Put back what others have written over the commands of running controllers.

        Args:
            loaded: All controllers; those that run have been updated in this cycle.
        """
        for one in loaded:
            commands = one.commands
            if one.controller.state is not _RUNNING or commands.is_shared:
                continue
            if not commands.is_as_written():
                self._note(f"the commands of '{one.info.name}'")
            # Written in any case: what equals a command may be no float, e.g. 0j.
            commands.write_again()

    def close(self, loaded: Iterable[LoadedController]) -> None:
        """Let every resource without an owner hold its rest command.

        Args:
            loaded: All controllers; those that run own what they claim.
        """
        if self.traced_cycles:
            self.traced_cycles -= 1
        if self.is_stale:
            self._note_owners(loaded)
            self.is_stale = False
        else:
            self.put_to_rest()

    def put_to_rest(self) -> None:
        """Write the rest of every resource without an owner.

        Also at the beginning of a traced cycle, so that what was written between two
        cycles is not charged to the controller that is called next.
        """
        # Written in any case: what equals the rest may still be no float, e.g. 0j.
        for storage, rest in self._whole:
            if _differs(storage, rest):
                self._note(f"the command of '{self._changed(storage, 0, rest)}'")
            storage[:] = rest
        for storage, piece, rest in self._parts:
            if _differs(storage[piece], rest):
                name = self._changed(storage, piece.start, rest)
                self._note(f"the command of '{name}'")
            storage[piece] = rest

    def find_intrusion(
        self, one: LoadedController, loaded: Iterable[LoadedController]
    ) -> str | None:
        """Return which command a call of `one` has written without owning it.

        Asked after every update while the gate traces. What was written is put back.

        Args:
            one: The controller that was called.
            loaded: All controllers; those before `one` have been updated already.
        """
        for other in loaded:
            if other is one:
                break
            if (
                other.controller.state is _RUNNING
                and not other.commands.is_as_written()
            ):
                other.commands.write_again()
                return f"the commands of '{other.info.name}'"
        for storage, piece, rest in self._resting():
            if _differs(storage[piece], rest):
                name = self._changed(storage, piece.start, rest)
                storage[piece] = rest
                return f"the command of '{name}'"
        return None

    def _resting(self) -> Iterator[tuple[list[float], slice, list[float]]]:
        """Yield the commands without an owner as (storage, slice, rest)."""
        for storage, rest in self._whole:
            yield storage, slice(0, len(rest)), rest
        yield from self._parts

    def _note_owners(self, loaded: Iterable[LoadedController]) -> None:
        """Find out which commands nobody owns, and let them rest.

        A resource that had no owner before keeps its rest command: resting anew where
        it is measured would let a joint under load creep a little at every switch.
        """
        owned = _count_owners(loaded)
        before = {
            (id(storage), index): value
            for storage, piece, rest in self._resting()
            for index, value in zip(range(piece.start, piece.stop), rest, strict=True)
        }
        free: dict[Slot, tuple[list[float], int]] = {}
        for guard in self._guards:
            begun = []
            for position, (storage, index) in enumerate(guard.slots):
                slot = (id(storage), index)
                if slot in owned:
                    continue
                free[slot] = (storage, index)
                if slot in before:
                    storage[index] = before[slot]
                else:
                    begun.append(position)
            if begun:
                guard.write_rest(begun)
        self._whole.clear()
        self._parts.clear()
        for storage, piece in as_pieces([free[slot] for slot in sorted(free)]):
            if piece.stop - piece.start == len(storage):
                self._whole.append((storage, storage[:]))
            else:
                self._parts.append((storage, piece, storage[piece]))

    def _changed(self, storage: list[float], first: int, rest: list[float]) -> str:
        for index, value in enumerate(rest, first):
            if _differs([storage[index]], [value]):
                return self._names[id(storage), index]
        return "an unknown resource"

    def _note(self, what: str) -> None:
        self.violations += 1
        self.last_violation = f"Somebody without a claim has written {what}."
        self.traced_cycles = TRACED_CYCLES


def _differs(values: list[float], rest: list[float]) -> bool:
    """Return whether commands are not those of before, whatever they are now."""
    try:
        return values != rest
    except CONTAINED:  # e.g. an array: its comparison has no truth value
        return True


def _count_owners(loaded: Iterable[LoadedController]) -> Counter[Slot]:
    """Count the owners of every command, and note who shares commands."""
    running = [one for one in loaded if one.controller.state is _RUNNING]
    owned = Counter(
        (id(storage), index) for one in running for storage, index in one.commands.slots
    )
    for one in running:
        one.commands.is_shared = any(
            owned[id(storage), index] > 1 for storage, index in one.commands.slots
        )
    return owned
