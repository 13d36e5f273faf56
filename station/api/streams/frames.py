"""Write frames as JSON text or msgpack, once for all clients of a channel."""

from typing import NamedTuple

import msgspec.msgpack
import orjson
from websockets.frames import Frame as WebSocketFrame, Opcode

from station.api.streams.cycle_samples import Data, Payload
from station.wire import StreamFormat

_msgpack = msgspec.msgpack.Encoder()


class Frame(NamedTuple):
    """An encoded message.

    Attributes:
        seq: Its number in its stream.
        message: The message, JSON or msgpack.
        wire: The message in its WebSocket frame. A server does not mask frames, so all
            clients get the same bytes.
    """

    seq: int
    message: bytes
    wire: bytes


def encode(
    topic: str,
    payload: Payload,
    *,
    seq: int,
    format: StreamFormat,  # noqa: A002 - the word in the URL
    fields: frozenset[str] = frozenset(),
    boot_id: str = "",
) -> Frame:
    """Encode a frame.

    Args:
        topic: Name of the topic, or `hello`.
        payload: Content; numbers that are not finite become null in JSON.
        seq: Its number in its stream.
        format: Encoding of the frame.
        fields: Keys to send of the data, or of each sample in a batch; empty sends all.
            A batch keeps its other keys.
        boot_id: Identifier of the station's run; left out if empty.
    """
    message: Data = {
        "topic": topic,
        "seq": seq,
        "epoch": payload.epoch,
        "cycle": payload.cycle,
        "stamp": payload.stamp,
        "data": _selected(payload.data, fields) if fields else payload.data,
    }
    if boot_id:
        message["boot_id"] = boot_id
    if format == "json":
        return _frame(seq, Opcode.TEXT, orjson.dumps(message))
    return _frame(seq, Opcode.BINARY, _msgpack.encode(message))


def _frame(seq: int, opcode: Opcode, message: bytes) -> Frame:
    wire = WebSocketFrame(opcode, message).serialize(mask=False)
    return Frame(seq, message, wire)


def _selected(data: Data, fields: frozenset[str]) -> Data:
    samples = data.get("samples")
    if not isinstance(samples, list):
        return {key: value for key, value in data.items() if key in fields}
    kept = fields | {"cycle"}
    chosen = [{key: s[key] for key in s if key in kept} for s in samples]
    batch: Data = {**data, "samples": chosen}
    for head in ("name", "arm_id"):
        if head not in fields:
            batch.pop(head, None)
    return batch
