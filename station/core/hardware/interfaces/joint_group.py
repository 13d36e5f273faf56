"""Read and write a group of joints in one call, which is faster than joint by joint.

A robot usually keeps its joints in consecutive slots of the same lists. A group of such
handles reads with one slice and writes with one slice assignment. Any other group
accesses the joints one by one, with the same result.
"""

from collections.abc import Sequence

from station.core.hardware.interfaces.joint import JointHandle, JointStateHandle


def _common_slice(storages: list[list[float]], indices: list[int]) -> slice | None:
    """Return the slice that covers all slots in order, or None if there is none."""
    first = indices[0] if indices else 0
    same = all(storage is storages[0] for storage in storages)
    if not same or indices != list(range(first, first + len(indices))):
        return None
    return slice(first, first + len(indices))


class _Column:
    """One quantity of a group of joints: storages, indices, and a slice if possible."""

    def __init__(self, storages: list[list[float]], indices: list[int]) -> None:
        self._slots = list(zip(storages, indices, strict=True))
        self._storage: list[float] = storages[0] if storages else []
        self._slice = _common_slice(storages, indices)

    def read(self) -> list[float]:
        if self._slice is not None:
            return self._storage[self._slice]
        return [storage[index] for storage, index in self._slots]

    def write(self, values: list[float]) -> None:
        if self._slice is not None:
            self._storage[self._slice] = values
            return
        for (storage, index), value in zip(self._slots, values, strict=True):
            storage[index] = value


class JointStateGroup:
    """Reads the states of several joints, in the order of `handles`.

    Attributes:
        names: Names of the joints.
    """

    def __init__(self, handles: Sequence[JointStateHandle]) -> None:
        self.names = [handle.name for handle in handles]
        indices = [handle.index for handle in handles]
        self._position = _Column([h.position_storage for h in handles], indices)
        self._velocity = _Column([h.velocity_storage for h in handles], indices)
        self._effort = _Column([h.effort_storage for h in handles], indices)

    def get_positions(self) -> list[float]:
        """Return the positions [rad or m], shape (n,), a new list."""
        return self._position.read()

    def get_velocities(self) -> list[float]:
        """Return the velocities [rad/s or m/s], shape (n,), a new list."""
        return self._velocity.read()

    def get_efforts(self) -> list[float]:
        """Return the efforts [Nm or N], shape (n,), a new list."""
        return self._effort.read()


class JointGroup(JointStateGroup):
    """Reads and commands several joints, in the order of `handles`."""

    def __init__(self, handles: Sequence[JointHandle]) -> None:
        super().__init__(handles)
        self._size = len(handles)
        self._command = _Column(
            [handle.command_storage for handle in handles],
            [handle.command_index for handle in handles],
        )

    def get_commands(self) -> list[float]:
        """Return the values commanded last, shape (n,), a new list."""
        return self._command.read()

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
