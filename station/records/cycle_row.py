"""A cycle as one piece of bytes, which the garbage collector does not look at.

Ten seconds of cycles stay in memory for incidents. As tuples and dictionaries they
would be ten thousand objects to be traversed at every collection, in whatever thread
it begins; as bytes they are none.
"""

import struct
from collections.abc import Callable, Sequence
from typing import NamedTuple

from station.core.control.controller import unpack_sample
from station.core.loop.snapshot import Record

# Cycle, epoch, time, period, number of the form, bytes of the joints.
_HEAD = struct.Struct("<QQddII")
_COLUMNS = 4
_DOUBLE = 8


class SampleForm(NamedTuple):
    """The form of a controller's sample.

    Attributes:
        name: The controller.
        elements: Names of the elements of its four lists.
    """

    name: str
    elements: tuple[str, ...]


class RowForm(NamedTuple):
    """The layout that many cycles share.

    Attributes:
        mode: The robot's mode.
        joints: Names of the joints.
        samples: The forms of the samples, in their order.
        sizes: Bytes of each sample.
    """

    mode: str
    joints: tuple[str, ...]
    samples: tuple[SampleForm, ...]
    sizes: tuple[int, ...]


class Row(NamedTuple):
    """A cycle, with its numbers still packed.

    Attributes:
        cycle: Number of the cycle.
        epoch: The station's epoch in that cycle.
        time: Station time [s].
        period: Time since the cycle before [s].
        form: What the numbers belong to.
        joints: Positions, velocities and efforts as doubles, one after the other.
        samples: The four lists of each sample as doubles, one after the other.
    """

    cycle: int
    epoch: int
    time: float
    period: float
    form: RowForm
    joints: memoryview
    samples: tuple[memoryview, ...]


class RowPacker:
    """Packs cycles, and unpacks what it has packed.

    Args:
        joints: Names of the joints in the snapshots.
        elements: Returns the names of the elements of a controller's sample; asked
            once for every form.
    """

    def __init__(
        self, joints: Sequence[str], elements: Callable[[str], Sequence[str]]
    ) -> None:
        self._joints = tuple(joints)
        self._elements = elements
        self._forms: list[RowForm] = []
        self._indices: dict[tuple[str, tuple[str, ...], tuple[int, ...]], int] = {}

    def pack(self, record: Record) -> bytes:
        """Return a cycle as bytes.

        Args:
            record: The cycle as the ring of snapshots has it.
        """
        cycle, epoch, time, period, mode, joints, samples = record
        pieces = [unpack_sample(one).memory() for one in samples.values()]
        key = (mode, tuple(samples), tuple(map(len, pieces)))
        index = self._indices.get(key)
        if index is None:
            index = self._add_form(*key)
        head = _HEAD.pack(cycle, epoch, time, period, index, len(joints))
        return b"".join((head, joints, *pieces))

    def unpack(self, row: bytes) -> Row:
        """Return the cycle in a packed row."""
        cycle, epoch, time, period, index, size = _HEAD.unpack_from(row)
        form = self._forms[index]
        memory, at = memoryview(row), _HEAD.size + size
        joints = memory[_HEAD.size : at]
        samples = []
        for length in form.sizes:
            samples.append(memory[at : at + length])
            at += length
        return Row(cycle, epoch, time, period, form, joints, tuple(samples))

    def _add_form(
        self, mode: str, names: tuple[str, ...], sizes: tuple[int, ...]
    ) -> int:
        forms = []
        for name, size in zip(names, sizes, strict=True):
            known, count = self._elements(name), size // (_COLUMNS * _DOUBLE)
            numbered = (str(number) for number in range(count))
            # A controller may sample another number of elements than it has joints.
            elements = tuple(known) if len(known) == count else tuple(numbered)
            forms.append(SampleForm(name, elements))
        self._forms.append(RowForm(mode, self._joints, tuple(forms), sizes))
        index = self._indices[mode, names, sizes] = len(self._forms) - 1
        return index
