"""The gate between whatever wrote a command and the robot.

Before every `write` each command of the robot is a real finite float that its one owner
has written, or the rest command of a resource that nobody owns:

1. After every call of a controller its own commands are checked and copied
   (`ControllerCommands.refused`), so that a bad value is charged to that call.
2. At the end of the cycle `close` writes all of them anew: the rest of what nobody
   owns, and what each owner wrote if others ran beside it. So nothing else reaches the
   robot.
3. Around every call of a controller in a switch, and around `do_switch`, the commands
   of the others are remembered and put back (`CommandGate.remember`, `put_back`).
4. Before it writes, `close` compares one group of commands with what is there, another
   one in every cycle. After a difference the gate traces: it compares all of them after
   every call, and the controller that writes what it does not own is stopped.

The ranges of the commands are the robot's business: `RobotHW.write` enforces the joint
limits, which depend on the measured state and on the period.
"""

from collections import Counter
from collections.abc import Iterable

from station.core.control.command_guard import all_guards
from station.core.control.command_piece import KeptPiece, make_pieces
from station.core.control.command_pieces import CommandPieces
from station.core.control.controller import ControllerState
from station.core.control.controller_round import OwnerFlags
from station.core.control.loaded_controller import LoadedController
from station.core.hardware.robot_hw import RobotHW
from station.core.hardware.slots import Slot, in_memory_order
from station.memory.doubles import Storage

_RUNNING = ControllerState.RUNNING

TRACED_CYCLES = 1000
"""How long the gate looks for whoever writes commands without a claim [cycles]."""

SlotId = tuple[int, int]
"""Identity of a storage and an index into it."""

Remembered = list[tuple[Storage, int, float]]
"""Commands as (storage, index, value)."""


class CommandGate(OwnerFlags):
    """Keeps the commands of a robot with their owners. Control thread only.

    Args:
        hw: The robot, initialised.

    Attributes:
        is_stale: Whether controllers have started or stopped since the owners were
            noted; set by whoever starts or stops one.
        kept: The commands that are written anew at the end of a cycle.
        running: The controllers that ran when the owners were noted last.
        traced_cycles: For how many cycles more the gate looks after every call for
            whoever writes commands that it does not own; 0 until a violation is found.
        violations: How often a command was found that its owner had not written.
        last_violation: The last of them as a sentence; None if there was none.
    """

    def __init__(self, hw: RobotHW) -> None:
        super().__init__()
        self.running: tuple[LoadedController, ...] = ()
        self.violations = 0
        self.last_violation: str | None = None
        self._guards = all_guards(hw)
        # Commands that nobody owns, with their rest; and all that are written anew.
        self._resting: list[KeptPiece] = []
        self._note_rows([])
        self._owned_names: set[str] = set()
        self._names: dict[SlotId, str] = {
            (id(storage), index): guard.name
            for guard in self._guards
            for storage, index in guard.slots
        }
        commands = in_memory_order(slot for one in self._guards for slot in one.slots)
        self._slots: dict[SlotId, Slot] = {
            (id(storage), index): (storage, index) for storage, index in commands
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
        self._resting = []
        self._note_rows([])
        self.is_stale = True

    def close(self, loaded: Iterable[LoadedController]) -> None:
        """Write every command anew: that of its owner, or the rest.

        Args:
            loaded: All controllers; those that run own what they claim.
        """
        if self.is_stale or self.traced_cycles:
            self._close_with_care(loaded)
            return
        self.kept.keep()

    def _close_with_care(self, loaded: Iterable[LoadedController]) -> None:
        """Do the same in a cycle in which owners have changed, or that is traced."""
        if self.traced_cycles:
            self.traced_cycles -= 1
        if self.is_stale:
            self._note_owners(loaded)
            self.is_stale = False
        else:
            self.restore()

    def restore(self) -> None:
        """Compare all commands with what they ought to be, and write them anew.

        Also before a switch, after which the owners are others, and at the beginning of
        a traced cycle, so that what was written between two cycles is not charged to
        the controller that is called next. Nothing happens when owners have changed in
        this cycle already: `close` looks at all of them then.
        """
        if self.is_stale:
            return
        for piece in self._rows:
            if piece.differs():
                self._report(piece)
            piece.write()

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
        for piece in self._resting:
            if piece.differs():
                name = self._changed(piece)
                piece.write()
                return f"the command of '{name}'"
        return None

    def _note_owners(self, loaded: Iterable[LoadedController]) -> None:
        """Find out which commands nobody owns, and let them rest.

        A resource that had no owner before keeps its rest command: resting anew where
        it is measured would let a joint under load creep a little at every switch. One
        that had an owner has moved meanwhile, so all of its commands rest anew, those
        of other interfaces as well.
        """
        owned = _count_owners(loaded)
        before = {
            (id(storage), index): value
            for piece in self._resting
            for (storage, index), value in zip(piece.slots, piece.values, strict=True)
        }
        for guard in self._guards:
            begun = []
            for position, (storage, index) in enumerate(guard.slots):
                slot = (id(storage), index)
                if slot in owned:
                    continue
                if slot in before and guard.name not in self._owned_names:
                    storage[index] = before[slot]
                else:
                    begun.append(position)
            if begun:
                guard.write_rest(begun)
        free = [slot for name, slot in self._slots.items() if name not in owned]
        self._resting = make_pieces(free)
        self.running = tuple(one for one in loaded if one.controller.state is _RUNNING)
        running = self.running
        self._owned_names = {g.name for one in running for g in one.commands.guards}
        owners = [one for one in running if not one.commands.is_shared]
        for one in owners:
            one.commands.write_again()
        # With nobody beside it, what the only controller has written stays as it is.
        beside = owners if len(running) > 1 else []
        owned_pieces = [piece for one in beside for piece in one.commands.pieces]
        self._note_rows([*self._resting, *owned_pieces])

    def _note_rows(self, rows: list[KeptPiece]) -> None:
        self._rows = rows
        self.kept = CommandPieces([*rows], self._report)

    def _changed(self, piece: KeptPiece) -> str:
        for (storage, index), value in zip(piece.slots, piece.values, strict=True):
            now = storage[index]
            if not (type(now) is float and now == value):
                return self._names[id(storage), index]
        return "an unknown resource"

    def _report(self, piece: KeptPiece) -> None:
        """Note that somebody has written commands that are not theirs, and trace."""
        self.violations += 1
        self.last_violation = (
            "Somebody without a claim has written the command of "
            f"'{self._changed(piece)}'."
        )
        self.traced_cycles = TRACED_CYCLES


def _count_owners(loaded: Iterable[LoadedController]) -> Counter[SlotId]:
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
