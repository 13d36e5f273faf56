"""Slots, in which a robot keeps single numbers, and runs of adjacent slots.

Adjacent numbers are read and written at once, which is faster than one by one. Views of
the same block of doubles may be adjacent, too.
"""

from collections.abc import Iterable
from ctypes import addressof, c_char
from typing import TypeAlias

from typing_extensions import Buffer

from station.memory.doubles import Doubles, Storage

Slot: TypeAlias = tuple[Storage, int]
"""A storage and an index into it."""
# Identity of the memory that holds a slot, and the slot's place in it.
_Place: TypeAlias = tuple[int, int]

_BYTES = 8


class SlotRun:
    """Slots that lie side by side, in their order.

    Args:
        slots: The slots, at least one.

    Attributes:
        slots: As given.
        storage: List or doubles that hold all of the slots.
        begin: Index of the first slot in `storage`.
        end: Index after the last slot.
    """

    def __init__(self, slots: list[Slot]) -> None:
        self.slots = slots
        storage, begin = slots[0]
        end = begin + len(slots)
        if end > len(storage) and not isinstance(storage, list):
            # The slots reach into another view of the same memory.
            begin, storage = _place(storage) + begin, _all_of(storage)
            end = begin + len(slots)
        self.storage: Storage = storage
        self.begin, self.end = begin, end

    @property
    def view(self) -> Doubles | None:
        """Memory of the slots; None if a list holds them."""
        if isinstance(self.storage, list):
            return None
        return self.storage[self.begin : self.end]


def side_by_side(slots: Iterable[Slot]) -> list[SlotRun]:
    """Return the slots as a few runs, in their order."""
    found: list[list[Slot]] = []
    places = _Places()
    due: _Place | None = None
    for slot in slots:
        base, place = places.of(slot)
        if (base, place) == due:
            found[-1].append(slot)
        else:
            found.append([slot])
        due = base, place + 1
    return [SlotRun(run) for run in found]


def in_memory_order(slots: Iterable[Slot]) -> list[Slot]:
    """Return the slots in the order in which they lie in memory."""
    return sorted(slots, key=_Places().of)


class _Places:
    """Finds the places of slots; asks each storage once."""

    def __init__(self) -> None:
        self._known: dict[int, _Place] = {}

    def of(self, slot: Slot) -> _Place:
        storage, index = slot
        known = self._known.get(id(storage))
        if known is None:
            known = self._known[id(storage)] = _base(storage)
        base, begin = known
        return base, begin + index


def _base(storage: Storage) -> _Place:
    """Return the identity of a storage's memory, and the storage's offset in it."""
    # Only writable memory tells its address; any other memory has no neighbours.
    if isinstance(storage, list) or not isinstance(storage.obj, bytearray):
        return id(storage), 0
    return id(storage.obj), _place(storage)


def _place(view: Doubles) -> int:
    """Return the offset of a view in its memory, counted in doubles."""
    return (_address(view) - _address(view.obj)) // _BYTES


def _all_of(view: Doubles) -> Doubles:
    """Return a view of the whole memory to which a view belongs."""
    return memoryview(view.obj).cast("d")


def _address(memory: Buffer) -> int:
    return addressof(c_char.from_buffer(memory))
