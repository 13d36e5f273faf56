"""Encode and queue the messages to one client, which may read slowly or not at all.

Source: RobotWebTools/rosbridge_suite ROSBRIDGE_PROTOCOL.md, 3.1 to 3.4; RFC 8949 (CBOR)
and RFC 8746 (typed arrays).
"""

import asyncio
import base64
import struct
import zlib
from array import array
from collections import deque
from dataclasses import dataclass, field
from functools import cached_property
from itertools import count
from math import ceil, isqrt
from typing import Any, NamedTuple

import orjson
from websockets.frames import Frame, Opcode

from station.api.rosbridge.ros_types import Convert, changed, in_style, serialized
from station.api.streams.channel import StreamPort
from station.records.cdr import Field, Values

TEXT_COMPRESSIONS = ("none", "png")
COMPRESSIONS = (*TEXT_COMPRESSIONS, "cbor", "cbor-raw")
# RFC 8746: tag and `struct` code of arrays of numbers in little-endian order.
_TYPED_ARRAYS = {"float64": (86, "d"), "int32": (78, "i"), "uint32": (70, "I")}
_PIXEL = 3
_fragment_numbers = count()
MOST_ANSWERS = 1000
"""Most waiting answers for a client that does not read."""
MOST_BYTES = 8_000_000
"""Most bytes in all queues of a client together; enough for pictures of a few seconds.
"""
LEVELS = ("none", "error", "warning", "info")
"""Levels of statuses; each level includes those before it."""


class Form(NamedTuple):
    """The form in which a client gets a message.

    Attributes:
        compression: One of `COMPRESSIONS`.
        is_ros2: Whether times and headers have the form of ROS 2.
        fragment_size: Most characters of a frame; 0 for no limit.
        topic: The topic as the client has written it; empty for the topic's own name.
    """

    compression: str = "none"
    is_ros2: bool = False
    fragment_size: int = 0
    topic: str = ""


class Publication:
    """A message of a topic, which is encoded once per form for all subscribers.

    Args:
        topic: Name of the topic.
        type_name: Type of the message.
        message: The message.
        stamp: Wall time of the message [ns since 1970].
    """

    def __init__(self, topic: str, type_name: str, message: Values, stamp: int) -> None:
        self.topic = topic
        self._type = type_name
        self._message = message
        self._stamp = stamp
        self._made: dict[Form, bytes] = {}

    @cached_property
    def size(self) -> int:
        """Size of the message as JSON [bytes], which is similar in the other forms."""
        return len(orjson.dumps(self._message, default=_base64))

    def frames(self, form: Form) -> bytes:
        """Return the WebSocket frames of the message in a form."""
        found = self._made.get(form)
        if found is None:
            found = self._made[form] = self._make(form)
        return found

    def _make(self, form: Form) -> bytes:
        message = in_style(self._type, self._message, ros2=form.is_ros2)
        envelope = {"op": "publish", "topic": form.topic or self.topic}
        if form.compression in TEXT_COMPRESSIONS:
            return text_frames({**envelope, "msg": message}, form)
        if form.compression == "cbor":
            content = changed(self._type, _packed, message)
        else:
            seconds, rest = divmod(self._stamp, 1_000_000_000)
            data = serialized(self._type, self._message, ros2=form.is_ros2)
            content = {"secs": seconds, "nsecs": rest, "bytes": data}
        found = cbor({**envelope, "msg": content})
        return Frame(Opcode.BINARY, found).serialize(mask=False)


def text_frames(message: Values, form: Form) -> bytes:
    """Return a message as frames of JSON; as PNG or in fragments if the form says so.

    Args:
        message: The message; numbers that are not finite become null.
        form: The form; its compression is `none` or `png`.
    """
    # JSON has bytes, e.g. of a picture, as base64.
    data = orjson.dumps(message, default=_base64)
    if form.compression == "png":
        data = orjson.dumps({"op": "png", "data": _base64(png(data))})
    if not 0 < form.fragment_size < len(data):
        return _text(data)
    text, size = data.decode(), form.fragment_size
    head = {"op": "fragment", "id": f"fragment_{next(_fragment_numbers)}"}
    total = ceil(len(text) / size)
    parts = (text[k * size : (k + 1) * size] for k in range(total))
    return b"".join(
        _text(orjson.dumps({**head, "data": part, "num": k, "total": total}))
        for k, part in enumerate(parts)
    )


def _base64(data: bytes) -> str:
    return base64.b64encode(data).decode()


def _text(data: bytes) -> bytes:
    return Frame(Opcode.TEXT, data).serialize(mask=False)


def png(data: bytes) -> bytes:
    """Return data as the pixels of a nearly square picture, padded with line ends."""
    width = max(1, isqrt(len(data) // _PIXEL))
    height = ceil(len(data) / _PIXEL / width)
    padded = data.ljust(width * height * _PIXEL, b"\n")
    line = width * _PIXEL
    rows = (padded[k * line : (k + 1) * line] for k in range(height))
    # Every row begins with the number of its filter: 0 for none.
    pixels = zlib.compress(b"".join(b"\0" + row for row in rows))
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)  # 8 bits of RGB
    chunks = ((b"IHDR", head), (b"IDAT", pixels), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(body))
        + name
        + body
        + struct.pack(">I", zlib.crc32(name + body))
        for name, body in chunks
    )


class _Tagged(NamedTuple):
    """Data with a CBOR tag, which tells what they are."""

    tag: int
    data: bytes


def _packed(field: Field) -> Convert | None:
    """Return the function that packs an array of numbers; None for other fields."""
    if field.length is None or field.kind not in _TYPED_ARRAYS:
        return None
    tag, code = _TYPED_ARRAYS[field.kind]
    return lambda values: _Tagged(tag, array(code, values).tobytes())


def cbor(value: Any) -> bytes:  # noqa: ANN401 - what JSON has, and bytes
    """Return a value as CBOR."""
    if isinstance(value, _Tagged):
        return _head(6, value.tag) + cbor(value.data)
    if isinstance(value, bool) or value is None:
        return {False: b"\xf4", True: b"\xf5", None: b"\xf6"}[value]
    if isinstance(value, int):
        return _head(0, value) if value >= 0 else _head(1, -1 - value)
    if isinstance(value, float):
        return b"\xfb" + struct.pack(">d", value)
    if isinstance(value, bytes):
        return _head(2, len(value)) + value
    if isinstance(value, str):
        data = value.encode()
        return _head(3, len(data)) + data
    if isinstance(value, dict):
        members = (cbor(key) + cbor(one) for key, one in value.items())
        return _head(5, len(value)) + b"".join(members)
    return _head(4, len(value)) + b"".join(cbor(one) for one in value)


def _head(major: int, number: int) -> bytes:
    """Return the head of a CBOR value: its kind, and its length or number.

    Raises:
        ValueError: The number has more than 64 bits.
    """
    if number < 24:
        return bytes([major << 5 | number])
    for code, form in ((24, ">B"), (25, ">H"), (26, ">I"), (27, ">Q")):
        if number < 1 << 8 * struct.calcsize(form):
            return bytes([major << 5 | code]) + struct.pack(form, number)
    raise ValueError(f"{number} is too large for CBOR.")


@dataclass(slots=True)
class Subscription:
    """A client's subscriptions to one topic.

    Attributes:
        wishes: Throttle rate [s], queue length and form of each subscription, by its
            identifier.
        queue: Waiting messages, the oldest first.
        due: When the next message may be sent [s, clock of the event loop].
        size: Size of the waiting messages as JSON [bytes].
        lost: Number of messages that the client has lost because it did not read.
        throttle: Shortest throttle rate of the subscriptions [s].
        length: Length of the longest queue of the subscriptions.
        form: The form that was requested last.
    """

    wishes: dict[str, tuple[float, int, Form]] = field(default_factory=dict)
    queue: deque[Publication] = field(default_factory=deque)
    size: int = 0
    due: float = 0.0
    lost: int = 0
    throttle: float = 0.0
    length: int = 0
    form: Form = field(default_factory=Form)

    def settle(self) -> None:
        """Combine the wishes of all subscriptions into throttle, length and form."""
        throttles, lengths, forms = zip(*self.wishes.values(), strict=True)
        self.throttle, self.length = min(throttles), max(lengths)
        self.form = forms[-1]

    def push(self, publication: Publication) -> None:
        """Add a message to the queue."""
        self.queue.append(publication)
        self.size += publication.size

    def pop(self) -> Publication:
        """Remove the oldest message from the queue, and return it."""
        publication = self.queue.popleft()
        self.size -= publication.size
        return publication


class Outbox:
    """Sends answers at once, and messages of topics when they are due.

    A client that does not read loses the oldest messages of each topic, and is told
    their number; other clients do not wait for it. Use it in one event loop only.

    Args:
        port: The connection.
        half_tick: Half the time between two ticks [s], by which a message may be early.

    Attributes:
        subscriptions: Subscriptions of the client, by topic.
        level: The level of `LEVELS` up to which the client wants statuses.
        overflown: Event that is set when too many answers wait.
    """

    def __init__(self, port: StreamPort, half_tick: float) -> None:
        self.subscriptions: dict[str, Subscription] = {}
        self.level = "warning"
        self.overflown = asyncio.Event()
        self._port = port
        self._half_tick = half_tick
        self._answers: deque[bytes] = deque()

    def offer(self, publication: Publication, now: float) -> None:
        """Send or queue a message of a subscribed topic.

        Args:
            publication: The message.
            now: Clock of the event loop [s].
        """
        one = self.subscriptions[publication.topic]
        is_free = self._can_write()
        # Without a queue, the client wants messages that come too early to be left out.
        if is_free and not one.length and now + self._half_tick < one.due:
            return
        one.push(publication)
        while len(one.queue) > max(one.length, 1):
            one.pop()
            one.lost += not is_free
        self._flush(one, now)
        if one.queue:
            self._limit_bytes()

    def flush(self, now: float) -> None:
        """Send the queued messages that are due, if the client reads.

        Args:
            now: Clock of the event loop [s].
        """
        for topic, one in self.subscriptions.items():
            if one.queue:
                self._flush(one, now)
            if one.lost and self._can_write():
                text = f"{one.lost} messages of {topic} were lost"
                self.tell("warning", f"{text}: the client reads too slowly.")
                one.lost = 0

    def tell(self, level: str, text: str, identifier: object = None) -> None:
        """Send a status, unless the client does not want its level.

        Args:
            level: One of `LEVELS`.
            text: The event, as a sentence.
            identifier: Identifier of the client's message; None without one.
        """
        if LEVELS.index(level) <= LEVELS.index(self.level):
            self.answer({"op": "status", "level": level, "msg": text[:500]}, identifier)

    def answer(
        self, message: Values, identifier: object = None, form: Form | None = None
    ) -> None:
        """Send an answer, or keep it until the client reads.

        Args:
            message: The answer.
            identifier: Identifier of the client's message; None without one.
            form: Form of the answer; None for plain JSON.
        """
        if identifier is not None:
            message["id"] = identifier
        self._answers.append(text_frames(message, form or Form()))
        self._send_answers()
        if len(self._answers) > MOST_ANSWERS:
            self.overflown.set()

    def resume(self) -> None:
        """Send waiting messages to a client that reads again."""
        self._send_answers()
        self.flush(asyncio.get_running_loop().time())

    def _send_answers(self) -> None:
        while self._answers and self._port.is_writable():
            self._port.write_frame(self._answers.popleft())

    def _can_write(self) -> bool:
        return not self._answers and self._port.is_writable()

    def _limit_bytes(self) -> None:
        """Drop the oldest messages of the largest queue, until all queues fit."""
        found = self.subscriptions.values()
        while sum(one.size for one in found) > MOST_BYTES:
            # Shorten the largest queue, so that pictures do not displace small messages
            # of states.
            largest = max(found, key=lambda one: one.size)
            largest.pop()
            largest.lost += 1

    def _flush(self, one: Subscription, now: float) -> None:
        while one.queue and now + self._half_tick >= one.due and self._can_write():
            # Keep a steady rate: a late message must not delay the next one.
            is_steady = now - one.due < one.throttle
            one.due = (one.due if is_steady else now) + one.throttle
            self._port.write_frame(one.pop().frames(one.form))
