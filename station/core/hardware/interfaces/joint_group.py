"""Read and write a group of joints in one call, which is faster than joint by joint.

A robot usually keeps its joints in consecutive slots of the same lists or doubles. A
group of such handles reads with one slice and writes with one slice assignment. Any
other group accesses the joints one by one, with the same result.
"""

from array import array
from collections.abc import Callable, Sequence
from typing import TypeAlias, cast

import numpy as np

from station.core.hardware.interfaces.joint import JointHandle, JointStateHandle
from station.kernel.doubles import Doubles, Storage


def _common_slice(storages: list[Storage], indices: list[int]) -> slice | None:
    """Return the slice that covers all slots in order, or None if there is none."""
    first = indices[0] if indices else 0
    same = all(storage is storages[0] for storage in storages)
    if not same or indices != list(range(first, first + len(indices))):
        return None
    return slice(first, first + len(indices))


def _list_reader(storage: list[float], piece: slice) -> Callable[[], list[float]]:
    return lambda: storage[piece]


class _Column:
    """One quantity of a group of joints.

    Attributes:
        read: Return the values, shape (n,), a new list.
        view: The values themselves, if they lie side by side in a block of doubles.
    """

    def __init__(self, storages: list[Storage], indices: list[int]) -> None:
        self._slots = list(zip(storages, indices, strict=True))
        self._slice = _common_slice(storages, indices)
        self._list: list[float] | None = None
        self.view: Doubles | None = None
        self.read: Callable[[], list[float]] = self._read_slots
        if self._slice is not None and storages:
            storage = storages[0]
            if isinstance(storage, list):
                self._list = storage
                self.read = _list_reader(storage, self._slice)
            else:
                self.view = storage[self._slice]
                self.read = cast("Callable[[], list[float]]", self.view.tolist)

    def _read_slots(self) -> list[float]:
        return [storage[index] for storage, index in self._slots]

    def write(self, values: list[float]) -> None:
        if self.view is not None:
            self.view[:] = array("d", values)
        elif self._list is not None and self._slice is not None:
            self._list[self._slice] = values
        else:
            for (storage, index), value in zip(self._slots, values, strict=True):
                storage[index] = value


Packed: TypeAlias = bytes | tuple[list[float], list[float], list[float]]
"""Positions, velocities and efforts of several joints at one time, as they are quickest
to keep: the bytes of doubles one after the other, or three lists."""


def packed_memory(packed: Packed) -> bytes:
    """Return positions, velocities and efforts as doubles, one after the other."""
    if isinstance(packed, bytes):
        return packed
    return b"".join(array("d", column).tobytes() for column in packed)


def unpack(packed: Packed) -> tuple[list[float], list[float], list[float]]:
    """Return positions, velocities and efforts, shape (n,) each."""
    if not isinstance(packed, bytes):
        return packed
    together = array("d", packed).tolist()
    size = len(together) // 3
    return together[:size], together[size : 2 * size], together[2 * size :]


class JointStateGroup:
    """Reads the states of several joints, in the order of `handles`.

    Attributes:
        names: Names of the joints.
        get_positions: Return the positions [rad or m], shape (n,), a new list.
        get_velocities: Return the velocities [rad/s or m/s], shape (n,), a new list.
        get_efforts: Return the efforts [Nm or N], shape (n,), a new list.
        positions: The positions themselves, if the robot keeps them side by side in a
            block of doubles; otherwise None. The same for `velocities` and `efforts`.
        pack: Return the present states, which are unpacked when somebody reads them.
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
        together = _side_by_side([position.view, velocity.view, effort.view])
        self.pack: Callable[[], Packed] = (
            self._pack_columns if together is None else together.tobytes
        )

    def _pack_columns(self) -> Packed:
        return self.get_positions(), self.get_velocities(), self.get_efforts()


def _side_by_side(views: list[Doubles | None]) -> Doubles | None:
    """Return the memory of some views that follow one another; None if they do not."""
    first = views[0]
    if first is None or any(view is None for view in views):
        return None
    block = memoryview(first.obj).cast("B").cast("d")
    size = len(first)
    start = _offset(first, block)
    for number, view in enumerate(views):
        if view is None or view.obj is not first.obj:
            return None
        if len(view) != size or _offset(view, block) != start + number * size:
            return None
    return block[start : start + len(views) * size]


def _offset(view: Doubles, block: Doubles) -> int:
    """Return the index in a block at which a view begins."""
    begin = np.asarray(view).ctypes.data - np.asarray(block).ctypes.data
    return begin // view.itemsize


class JointGroup(JointStateGroup):
    """Reads and commands several joints, in the order of `handles`.

    Attributes:
        get_commands: Return the values commanded last, shape (n,), a new list.
        commands: The commands themselves, as `positions`.
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
        """
        if len(commands) != self._size:
            raise ValueError(
                f"There are {len(commands)} commands for {self._size} joints."
            )
        self._command.write(commands)
