"""How frames are written: JSON text, or msgpack."""

from typing import NamedTuple

import msgspec.msgpack
import orjson

from station.api.streams.topics import Data, Payload
from station.wire import StreamFormat

_msgpack = msgspec.msgpack.Encoder()


class Frame(NamedTuple):
    """A message that is ready to be sent.

    Attributes:
        seq: Its number in its stream.
        text: The message when it is JSON.
        binary: The message when it is msgpack.
    """

    seq: int
    text: str | None
    binary: bytes | None


def encode(
    topic: str,
    payload: Payload,
    *,
    seq: int,
    format: StreamFormat,  # noqa: A002 - the word in the URL
    fields: frozenset[str] = frozenset(),
    boot_id: str = "",
) -> Frame:
    """Write a frame.

    Args:
        topic: Name of the topic, or `hello`.
        payload: What it says; numbers that are not finite become null in JSON.
        seq: Its number in its stream.
        format: How to write it.
        fields: Only these keys of the data, or of each sample of a batch; all when
            empty. A batch keeps its own keys.
        boot_id: The station's; left out when empty.
    """
    message: Data = {
        "topic": topic,
        "seq": seq,
        "epoch": payload.epoch,
        "stamp": payload.stamp,
        "data": _selected(payload.data, fields) if fields else payload.data,
    }
    if boot_id:
        message["boot_id"] = boot_id
    if format == "json":
        return Frame(seq, orjson.dumps(message).decode(), None)
    return Frame(seq, None, _msgpack.encode(message))


def _selected(data: Data, fields: frozenset[str]) -> Data:
    samples = data.get("samples")
    if not isinstance(samples, list):
        return {key: value for key, value in data.items() if key in fields}
    kept = fields | {"cycle"}
    chosen = [{key: s[key] for key in s if key in kept} for s in samples]
    batch: Data = {"samples": chosen, "lost": data["lost"]}
    return {"name": data["name"], **batch} if "name" in fields else batch
