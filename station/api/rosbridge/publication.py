"""Encode a message for subscribers: as JSON, PNG or CBOR, in WebSocket frames.

Source: RobotWebTools/rosbridge_suite ROSBRIDGE_PROTOCOL.md, 3.1 to 3.4; RFC 8949 (CBOR)
and RFC 8746 (typed arrays).
"""

import base64
import struct
import zlib
from array import array
from functools import cached_property
from itertools import count
from math import ceil, isqrt
from typing import Any, NamedTuple

import orjson
from websockets.frames import Frame, Opcode

from station.api.rosbridge.ros_types import Convert, changed, in_style, serialized
from station.records.cdr import Field, Values

TEXT_COMPRESSIONS = ("none", "png")
COMPRESSIONS = (*TEXT_COMPRESSIONS, "cbor", "cbor-raw")
# RFC 8746: tag and `struct` code of arrays of numbers in little-endian order.
_TYPED_ARRAYS = {"float64": (86, "d"), "int32": (78, "i"), "uint32": (70, "I")}
_PIXEL = 3
_fragment_numbers = count()


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
