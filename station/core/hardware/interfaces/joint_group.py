"""Read and write a group of joints in one call, which is faster than joint by joint.

A robot usually keeps its joints in consecutive slots of the same lists or doubles. A
group of such handles reads with one slice and writes with one slice assignment. Any
other group accesses the joints one by one, with the same result.
"""

from array import array
from collections.abc import Callable, Sequence
from typing import cast

from station.core.errors import is_number, refuse_non_number
from station.core.hardware.interfaces.joint import JointHandle, JointStateHandle
from station.core.hardware.slots import side_by_side
from station.memory.doubles import Doubles, Storage, zeros


def _list_reader(storage: list[float], piece: slice) -> Callable[[], list[float]]:
    return lambda: storage[piece]


class _Column:
    """One quantity of a group of joints.

    Attributes:
        read: Returns the values, shape (n,), a new list.
        view: Memory of the values, if they lie side by side in doubles; else None.
        slots: Memory of the values, as (storage, index).
    """

    def __init__(self, storages: list[Storage], indices: list[int]) -> None:
        self.slots = list(zip(storages, indices, strict=True))
        runs = side_by_side(self.slots)
        self._slice = slice(runs[0].begin, runs[0].end) if len(runs) == 1 else None
        self._list: list[float] | None = None
        self.view: Doubles | None = None
        self.read: Callable[[], list[float]] = self._read_slots
        if self._slice is not None:
            storage, self.view = runs[0].storage, runs[0].view
            if isinstance(storage, list):
                self._list = storage
                self.read = _list_reader(storage, self._slice)
            elif self.view is not None:
                self.read = cast("Callable[[], list[float]]", self.view.tolist)

    def _read_slots(self) -> list[float]:
        return [storage[index] for storage, index in self.slots]

    def write(self, values: list[float]) -> None:
        if self.view is not None:
            # The array refuses a value that is not a number, before any joint moves.
            self.view[:] = array("d", values)
        elif self._list is not None and self._slice is not None:
            self._list[self._slice] = values
        else:
            for (storage, index), value in zip(self.slots, values, strict=True):
                storage[index] = value


class JointStateGroup:
    """Reads the states of several joints, in the order of `handles`.

    Attributes:
        names: Names of the joints.
        get_positions: Returns the positions [rad or m], shape (n,), a new list.
        get_velocities: Returns the velocities [rad/s or m/s], shape (n,), a new list.
        get_efforts: Returns the efforts [Nm or N], shape (n,), a new list.
        positions: Memory of the positions, if the robot keeps them side by side in
            doubles; otherwise None. `velocities` and `efforts` likewise.
        blocks: Memory of the states: positions, velocities and efforts one after the
            other, in as few blocks as possible. A block is the robot's memory or a
            copy.
        refresh: Brings the copies up to date; None if there are none.
    """

    def __init__(self, handles: Sequence[JointStateHandle]) -> None:
        self.names = [handle.name for handle in handles]
        indices = [handle.index for handle in handles]
        position = _Column([h.position_storage for h in handles], indices)
        velocity = _Column([h.velocity_storage for h in handles], indices)
        effort = _Column([h.effort_storage for h in handles], indices)
        self.positions, self.velocities = position.view, velocity.view
        self.efforts = effort.view
        self.get_positions = position.read
        self.get_velocities = velocity.read
        self.get_efforts = effort.read
        columns = (position, velocity, effort)
        slots = [slot for column in columns for slot in column.slots]
        found = [run.view for run in side_by_side(slots)]
        self._columns = columns if None in found else ()
        size = len(handles)
        self._copies = [zeros(size) for _ in self._columns]
        self.blocks: list[Doubles] = self._copies or [
            block for block in found if block is not None
        ]
        self.refresh: Callable[[], None] | None = (
            self._refresh if self._columns else None
        )

    def _refresh(self) -> None:
        for copy, column in zip(self._copies, self._columns, strict=True):
            copy[:] = array("d", column.read())


class JointGroup(JointStateGroup):
    """Reads and commands several joints, in the order of `handles`.

    Attributes:
        get_commands: Returns the values commanded last, shape (n,), a new list.
        commands: Memory of the commands, as for `positions`.
    """

    def __init__(self, handles: Sequence[JointHandle]) -> None:
        super().__init__(handles)
        self._size = len(handles)
        self._command = _Column(
            [handle.command_storage for handle in handles],
            [handle.command_index for handle in handles],
        )
        self.commands = self._command.view
        self.get_commands = self._command.read

    def set_commands(self, commands: list[float]) -> None:
        """Command all joints.

        Args:
            commands: Commands in the unit of the interface, shape (n,).

        Raises:
            ValueError: `commands` has another length than the group.
            InvalidCommandError: A command is not a number.
        """
        if len(commands) != self._size:
            raise ValueError(
                f"There are {len(commands)} commands for {self._size} joints."
            )
        try:
            self._command.write(commands)
        except TypeError as error:
            self._refuse(commands, error)

    def _refuse(self, commands: list[float], error: TypeError) -> None:
        for name, command in zip(self.names, commands, strict=True):
            if not is_number(command):
                refuse_non_number(name, command)
        raise error
