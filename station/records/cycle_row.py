"""Pack a cycle into one `bytes` object, which the garbage collector does not traverse.

Ten seconds of cycles stay in memory for incidents. As tuples and dictionaries they
would be ten thousand objects for every collection to traverse, in whatever thread the
collection begins. A `bytes` object is not traversed.
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
    """The names and sizes that many cycles share.

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
        form: Names and sizes of the packed numbers.
        joints: All positions, then velocities, then efforts, as doubles.
        samples: The four lists of each controller's sample (desired, measured, error,
            output) as doubles, one after the other.
    """

    cycle: int
    epoch: int
    time: float
    period: float
    form: RowForm
    joints: memoryview
    samples: tuple[memoryview, ...]


class RowPacker:
    """Packs cycles into rows, and unpacks rows.

    Args:
        joints: Names of the joints in the snapshots.
        elements: Function that returns the names of the elements of a controller's
            sample. It is called whenever the mode or the running controllers change.
    """

    def __init__(
        self, joints: Sequence[str], elements: Callable[[str], Sequence[str]]
    ) -> None:
        self._joints = tuple(joints)
        self._elements = elements
        self._forms: list[RowForm] = []
        self._indices: dict[RowForm, int] = {}
        self._key: tuple[str, tuple[str, ...], tuple[int, ...]] | None = None
        self._index = 0

    def pack(self, record: Record) -> bytes:
        """Return a cycle as bytes.

        Args:
            record: The cycle, as read from the ring of snapshots.
        """
        cycle, epoch, time, period, mode, joints, samples = record
        pieces = [unpack_sample(one).memory() for one in samples.values()]
        key = (mode, tuple(samples), tuple(map(len, pieces)))
        # A controller that is loaded again under its name may have other joints. The
        # key changes even then, because a cycle without the controller lies between.
        if key != self._key:
            self._key, self._index = key, self._find_form(*key)
        head = _HEAD.pack(cycle, epoch, time, period, self._index, len(joints))
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

    def _find_form(
        self, mode: str, names: tuple[str, ...], sizes: tuple[int, ...]
    ) -> int:
        samples = []
        for name, size in zip(names, sizes, strict=True):
            known, count = self._elements(name), size // (_COLUMNS * _DOUBLE)
            numbered = (str(number) for number in range(count))
            # The number of sampled elements may differ from the number of names.
            elements = tuple(known) if len(known) == count else tuple(numbered)
            samples.append(SampleForm(name, elements))
        form = RowForm(mode, self._joints, tuple(samples), sizes)
        index = self._indices.setdefault(form, len(self._forms))
        if index == len(self._forms):
            self._forms.append(form)
        return index
