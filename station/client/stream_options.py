"""Parts of both kinds of stream: the address, the frames, the back-off."""

import random
import ssl
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal
from urllib.parse import quote, urlencode

from pydantic import JsonValue
from websockets.exceptions import ConnectionClosed, InvalidStatus

from station.client.errors import ApiError
from station.client.routes import PREFIX
from station.wire import (
    CLOSE_BAD_REQUEST,
    CLOSE_CONTROL_HELD,
    CLOSE_FORBIDDEN,
    CLOSE_UNAUTHORIZED,
    CLOSE_UNKNOWN_TOPIC,
    StreamFrame,
)

Rate = float | Literal["full"]
FIRST_DELAY: Final = 0.2
LONGEST_DELAY: Final = 5.0
MAX_FRAME_BYTES: Final = 16 * 1024 * 1024

REFUSALS: Mapping[int, tuple[str, str]] = {
    CLOSE_BAD_REQUEST: ("bad_stream_request", "Correct rate, fields or format."),
    CLOSE_UNAUTHORIZED: ("unauthorized", "Give the client the station's token."),
    CLOSE_FORBIDDEN: ("forbidden", "Use the address and token the station printed."),
    CLOSE_CONTROL_HELD: ("control_held", "Ask for control, or take it by force."),
    CLOSE_UNKNOWN_TOPIC: ("unknown_topic", "Ask for a topic the station has."),
}
"""Close codes after which connecting again is pointless: code and remedy."""


def bearer(token: str | None) -> dict[str, str]:
    """Return the header that carries `token`; none when there is no token."""
    return {} if token is None else {"Authorization": f"Bearer {token}"}


@dataclass(frozen=True, slots=True)
class StreamOptions:
    """Address and options of a stream.

    Attributes:
        base_url: The station, http or https.
        token: Operator or viewer token.
        topic: What to stream.
        rate: Frames per second [Hz], or "full"; None means the station's default.
        fields: Only these keys of `data`; all when empty.
        reconnect: Connect again when the link breaks.
        timeout: Longest wait for a connection [s].
        tls: How the station's certificate is checked; None for plain HTTP.
    """

    base_url: str
    token: str | None
    topic: str
    rate: Rate | None = None
    fields: tuple[str, ...] = ()
    reconnect: bool = True
    timeout: float = 10.0
    tls: ssl.SSLContext | None = None

    def url(self) -> str:
        """Return the WebSocket URL."""
        query: dict[str, str] = {}
        if self.rate is not None:
            query["rate"] = str(self.rate)
        if self.fields:
            query["fields"] = ",".join(self.fields)
        base = "ws" + self.base_url.removeprefix("http")
        path = f"{PREFIX}/streams/{quote(self.topic)}"
        return f"{base}{path}?{urlencode(query)}" if query else base + path


class Backoff:
    """Delays between attempts to connect: doubling, with jitter."""

    def __init__(self) -> None:
        self._delay = FIRST_DELAY

    def reset(self) -> None:
        """Begin again with the first delay, after a connection that worked."""
        self._delay = FIRST_DELAY

    def next(self) -> float:
        """Return the next delay [s], between half and all of the doubling one."""
        delay = self._delay
        self._delay = min(2.0 * delay, LONGEST_DELAY)
        return delay * random.uniform(0.5, 1.0)


class StreamProgress:
    """State of a stream.

    Attributes:
        connected: The link stands and its first frame has come.
        hello: The newest first frame: boot_id, epoch and a full snapshot.
        connections: How many times it connected.
    """

    def __init__(self) -> None:
        self.connected = False
        self.hello: StreamFrame | None = None
        self.connections = 0

    def accept(self, message: str | bytes) -> StreamFrame | None:
        """Read a message; return its frame, or None for the first message (`hello`)."""
        frame = StreamFrame.model_validate_json(message)
        if frame.topic == "hello":
            self.hello = frame
            self.connected = True
            self.connections += 1
            return None
        boot_id = self.hello.boot_id if self.hello is not None else ""
        return frame.model_copy(update={"boot_id": boot_id})

    def snapshot(self) -> dict[str, JsonValue]:
        """Return the full snapshot of the newest hello; empty before it."""
        return {} if self.hello is None else self.hello.data


def refusal(error: Exception) -> ApiError | None:
    """Return the error to raise when connecting again is pointless, else None."""
    if isinstance(error, InvalidStatus) and error.response.status_code < 500:
        return ApiError.from_body(
            error.response.status_code, bytes(error.response.body or b"")
        )
    if isinstance(error, ConnectionClosed) and error.rcvd is not None:
        known = REFUSALS.get(error.rcvd.code)
        if known is not None:
            return ApiError(
                error.rcvd.reason or "The station closed the stream.",
                status=error.rcvd.code,
                code=known[0],
                remedy=known[1],
            )
    return None
