"""uvicorn's WebSocket protocol, with a direct way for the frames of streams.

ASGI alone costs each client a task, a wait and an encoding for every frame, and has no
way to get rid of a client that reads nothing: its close waits behind the frames that
the client does not take.
"""

from collections.abc import Callable

from typing_extensions import override
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from websockets.http11 import Request

from station.api.streams.broadcaster import PORT

GRACE = 2.0
"""How long a client may take to read its close frame [s]."""


class StreamProtocol(WebSocketsSansIOProtocol):
    """A `StreamPort` that the application finds in the scope's state."""

    _resumed: Callable[[], None] | None = None

    @override
    def handle_connect(self, event: Request) -> None:
        super().handle_connect(event)
        if hasattr(self, "scope"):
            self.scope["state"][PORT] = self

    @override
    def resume_writing(self) -> None:
        super().resume_writing()
        if self._resumed is not None:
            self._resumed()

    def write_frame(self, wire: bytes) -> None:
        """Write a whole WebSocket frame, unless the connection is being closed.

        Args:
            wire: The frame, not masked; no extension changes it, because the server
                offers none.
        """
        if not self.close_sent and not self.transport.is_closing():
            self.transport.write(wire)

    def is_writable(self) -> bool:
        """Return whether the client reads its frames."""
        return self.writable.is_set()

    def listen(self, resumed: Callable[[], None] | None) -> None:
        """Call `resumed` whenever the client begins to read again."""
        self._resumed = resumed

    def abort(self, code: int, reason: str) -> None:
        """Send a close frame, then cut the connection even if nobody reads the frame.

        Args:
            code: Close code.
            reason: At most 123 bytes.
        """
        if self.close_sent or self.transport.is_closing():
            return
        self.stop_keepalive()
        self.conn.send_close(code, reason)
        self.transport.write(b"".join(self.conn.data_to_send()))
        self.close_sent = True
        if self.read_paused:
            self.read_paused = False
            self.transport.resume_reading()
        self.close_timer = self.loop.call_later(GRACE, self.transport.abort)
