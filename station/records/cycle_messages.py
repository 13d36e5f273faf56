"""Pack a cycle into one `bytes` object, and make its messages of it, in CDR.

Ten seconds of cycles stay in memory for incidents. As tuples and dictionaries they
would be ten thousand objects for every collection to traverse, in whatever thread the
collection begins. A `bytes` object is not traversed.
"""

import struct
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from station.core.control.controller import unpack_sample
from station.core.franka.franka_robot_state import MODE, SCALARS, array_places
from station.core.loop.snapshot import Record
from station.records import messages
from station.records.cdr import Layout, MessageType
from station.reports import Clearance

# Cycle, epoch, time, period, number of the form, bytes of the joints.
_HEAD = struct.Struct("<QQddII")
_DOUBLE = 8
JOINT_STATES = "/joint_states"
CYCLES = "/cycles"
CONTROLLERS = "/controllers/"
COMMANDS = "/commands/"
FRANKA_STATES = "/franka_state/"
CLEARANCES = "/clearance/"
_COLUMNS = ("desired", "actual", "error", "output")
_JOINTS = ("position", "velocity", "effort")


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
            known, count = self._elements(name), size // (len(_COLUMNS) * _DOUBLE)
            numbered = (str(number) for number in range(count))
            # The number of sampled elements may differ from the number of names.
            elements = tuple(known) if len(known) == count else tuple(numbered)
            samples.append(SampleForm(name, elements))
        form = RowForm(mode, self._joints, tuple(samples), sizes)
        index = self._indices.setdefault(form, len(self._forms))
        if index == len(self._forms):
            self._forms.append(form)
        return index


class Message(NamedTuple):
    """One message of a channel.

    Attributes:
        topic: The channel.
        kind: Type of the message.
        data: The message as CDR.
    """

    topic: str
    kind: MessageType
    data: bytes


class CycleMessages:
    """Makes the messages of cycles.

    Args:
        origin: Wall time of station time zero [ns since 1970]; the stamps of the
            messages are wall time, so that a recording says when it was made.
    """

    def __init__(self, origin: int) -> None:
        self.origin = origin
        self._joint_layouts: dict[tuple[str, ...], Layout] = {}
        self._sample_layouts: dict[SampleForm, Layout] = {}
        self._cycle_layouts: dict[str, Layout] = {}
        self._command_layouts: dict[tuple[str, ...], Layout] = {}
        self._franka = FrankaLayout()

    def stamp(self, time: float) -> int:
        """Return the wall time of a station time [ns since 1970]."""
        # Computed from station time, which runs evenly: the wall clock may be set
        # meanwhile.
        return self.origin + round(time * 1e9)

    def of_row(self, row: Row) -> Iterator[Message]:
        """Yield the messages of a cycle's row."""
        seconds, rest = divmod(self.stamp(row.time), 1_000_000_000)
        form = row.form
        yield Message(
            CYCLES,
            messages.CYCLE,
            self._cycle_layout(form.mode).pack(
                seconds, rest, row.cycle, row.epoch, row.time, row.period
            ),
        )
        size = len(row.joints) // 3
        columns = [bytes(row.joints[k * size : (k + 1) * size]) for k in range(3)]
        layout = self._joint_layout(form.joints)
        yield Message(
            JOINT_STATES, messages.JOINT_STATE, layout.pack(seconds, rest, *columns)
        )
        for sample, memory in zip(form.samples, row.samples, strict=True):
            size = len(memory) // 4
            columns = [bytes(memory[k * size : (k + 1) * size]) for k in range(4)]
            yield Message(
                f"{CONTROLLERS}{sample.name}",
                messages.CONTROLLER_STATE,
                self._sample_layout(sample).pack(seconds, rest, *columns),
            )

    def of_commands(
        self, quantity: str, time: float, names: tuple[str, ...], commands: bytes
    ) -> Message:
        """Return the message with the commands that reached the robot in a cycle.

        Args:
            quantity: position, velocity or effort.
            time: Station time [s].
            names: The joints.
            commands: One double per joint, in the unit of the quantity.
        """
        layout = self._command_layouts.get(names)
        if layout is None:
            fixed = {"name": names, "frame_id": ""}
            layout = Layout(messages.JOINT_COMMANDS, fixed, {"command": len(names)})
            self._command_layouts[names] = layout
        seconds, rest = divmod(self.stamp(time), 1_000_000_000)
        data = layout.pack(seconds, rest, commands)
        return Message(f"{COMMANDS}{quantity}", messages.JOINT_COMMANDS, data)

    def of_arm(
        self,
        arm_id: str,
        time: float,
        state: tuple[bytes, tuple[float, ...], tuple[bool, ...]],
    ) -> Message:
        """Return the message with the whole state of an arm in a cycle.

        Args:
            arm_id: The arm.
            time: Station time [s].
            state: As `RobotState.packed` returns it.
        """
        data = self._franka.pack(divmod(self.stamp(time), 1_000_000_000), state)
        return Message(f"{FRANKA_STATES}{arm_id}", messages.FRANKA_STATE, data)

    def of_clearance(self, time: float, pair: Clearance) -> Message:
        """Return the message with the nearest pair of an arm in a cycle.

        Args:
            time: Station time [s].
            pair: The pair.
        """
        kind = messages.CLEARANCE
        values = {field.name: getattr(pair, field.name, None) for field in kind.fields}
        values["header"] = messages.header(self.stamp(time))
        return Message(f"{CLEARANCES}{pair.arm}", kind, kind.encode(values))

    def of_text(self, topic: str, text: str) -> Message:
        """Return a `std_msgs/String`."""
        return Message(topic, messages.STRING, messages.STRING.encode({"data": text}))

    def _joint_layout(self, names: tuple[str, ...]) -> Layout:
        layout = self._joint_layouts.get(names)
        if layout is None:
            lengths = dict.fromkeys(_JOINTS, len(names))
            fixed = {"name": names, "frame_id": ""}
            layout = Layout(messages.JOINT_STATE, fixed, lengths)
            self._joint_layouts[names] = layout
        return layout

    def _sample_layout(self, form: SampleForm) -> Layout:
        layout = self._sample_layouts.get(form)
        if layout is None:
            lengths = dict.fromkeys(_COLUMNS, len(form.elements))
            fixed = {"name": form.elements, "frame_id": ""}
            layout = Layout(messages.CONTROLLER_STATE, fixed, lengths)
            self._sample_layouts[form] = layout
        return layout

    def _cycle_layout(self, mode: str) -> Layout:
        layout = self._cycle_layouts.get(mode)
        if layout is None:
            layout = Layout(messages.CYCLE, {"mode": mode, "frame_id": ""}, {})
            self._cycle_layouts[mode] = layout
        return layout


class FrankaLayout:
    """Encodes the state of an arm as `franka_msgs/FrankaState`."""

    def __init__(self) -> None:
        self._layout = Layout(messages.FRANKA_STATE, {"frame_id": ""}, {})
        # The message has the names in lower case, as ROS 2 wants them.
        places = {name.lower(): place for name, place in array_places().items()}
        self._mode = places[MODE]
        # For each field of the message, in order: the slice of an array, or the index
        # of a scalar.
        self._sources: list[slice | int] = []
        for field in messages.FRANKA_STATE.fields:
            if field.name in SCALARS:
                self._sources.append(SCALARS.index(field.name))
            elif field.length is not None:
                self._sources.append(places[field.name])

    def pack(
        self,
        stamp: tuple[int, int],
        state: tuple[bytes, tuple[float, ...], tuple[bool, ...]],
    ) -> bytes:
        """Return a `FrankaState` as CDR.

        Args:
            stamp: Seconds and nanoseconds.
            state: As `RobotState.packed` returns it.
        """
        block, scalars, flags = state
        values: list[float | bytes] = [
            scalars[source] if isinstance(source, int) else block[source]
            for source in self._sources
        ]
        mode = int(memoryview(block[self._mode]).cast("d")[0])
        half = len(flags) // 2
        current = [flags[place] for place in messages.ERROR_ORDER]
        last = [flags[half + place] for place in messages.ERROR_ORDER]
        return self._layout.pack(*stamp, *values, mode, *current, *last)
