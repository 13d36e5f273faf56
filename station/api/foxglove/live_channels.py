"""Send the newest cycle as the channels of a recording to subscribers."""

import time
from collections.abc import Collection, Iterator, Mapping
from typing import TYPE_CHECKING, NamedTuple

from station.core.description.urdf import Urdf
from station.core.errors import StationError
from station.core.facade.station import Station
from station.records import messages
from station.records.cycle_messages import CycleMessages, Message, Row, RowPacker
from station.records.messages import transforms

if TYPE_CHECKING:
    from station.records.cdr import MessageType

TRANSFORMS = "/tf"


class LiveMessage(NamedTuple):
    """A message of the newest cycle.

    Attributes:
        topic: The channel.
        stamp: Wall time of the cycle [ns since 1970].
        data: The message as CDR.
    """

    topic: str
    stamp: int
    data: bytes


class LiveChannels:
    """Channels with values of the newest cycle. Use it in one event loop only.

    Args:
        station: The station.
        urdf: The robot, for transforms; None sends no transforms.
        texts: Texts for subscribers, by topic such as `/robot_description`.

    Attributes:
        boot_id: Random name of the run of the station.
        kinds: Message types by topic, of all channels so far.
    """

    def __init__(
        self,
        station: Station,
        urdf: Urdf | None = None,
        texts: Mapping[str, str] | None = None,
    ) -> None:
        self._station = station
        self._urdf = urdf
        self._texts = dict(texts or {})
        loop = station.loop
        self._encoder = CycleMessages(time.time_ns() - round(loop.time * 1e9))
        self._packer = RowPacker(station.joint_names, self._elements)
        self._cycle = 0
        self.boot_id = station.boot_id
        self.kinds: dict[str, MessageType] = {}
        if urdf is not None:
            self.kinds[TRANSFORMS] = messages.TF_MESSAGE
        for topic in self._texts:
            self.kinds[topic] = messages.STRING

    def newest(self, wanted: Collection[str]) -> list[LiveMessage]:
        """Return the messages of the newest cycle; none if they were returned before.

        All messages, including transforms, come from the same row, so equal stamps mean
        the same cycle.

        Args:
            wanted: The channels with a subscriber.
        """
        loop = self._station.loop
        rows = self._station.snapshots.rows_since(
            max(self._cycle, self._station.snapshots.newest - 1)
        )
        if not len(rows):
            return []
        loop.cycle_yield.wait_if_cycle_is_due()
        row = self._packer.unpack(self._packer.pack(rows.record(len(rows) - 1)))
        self._cycle = row.cycle
        stamp = self._encoder.stamp(row.time)
        found = []
        for message in self._messages(row, wanted):
            self.kinds.setdefault(message.topic, message.kind)
            if message.topic in wanted:
                found.append(LiveMessage(message.topic, stamp, message.data))
        return found

    def text(self, topic: str) -> LiveMessage | None:
        """Return the constant text of a channel; None for other channels."""
        text = self._texts.get(topic)
        if text is None:
            return None
        message = self._encoder.of_text(topic, text)
        stamp = self._encoder.stamp(self._station.loop.time)
        return LiveMessage(topic, stamp, message.data)

    def _messages(self, row: Row, wanted: Collection[str]) -> Iterator[Message]:
        yield from self._encoder.of_row(row)
        if self._urdf is None or TRANSFORMS not in wanted:
            return
        self._station.loop.cycle_yield.wait_if_cycle_is_due()
        values = row.joints.cast("d")
        names = row.form.joints
        positions = dict(zip(names, values[: len(names)], strict=True))
        stamp = self._encoder.stamp(row.time)
        data = messages.TF_MESSAGE.encode(transforms(self._urdf, positions, stamp))
        yield Message(TRANSFORMS, messages.TF_MESSAGE, data)

    def _elements(self, name: str) -> list[str]:
        try:
            return list(self._station.manager.get_controller(name).joint_names)
        except StationError:
            return []  # unloaded meanwhile; its elements get numbers
