"""uvicorn's WebSocket protocol, with a way to get rid of a client that reads nothing.

ASGI alone cannot: its close waits behind the frames that the client does not take.
"""

from typing_extensions import override
from uvicorn.protocols.websockets.websockets_sansio_impl import (
    WebSocketsSansIOProtocol,
)
from websockets.http11 import Request

from station.api.streams.broadcaster import ABORT

GRACE = 2.0
"""How long a client may take to read its close frame [s]."""


class StreamProtocol(WebSocketsSansIOProtocol):
    """Adds `abort` to the state that the application finds in the scope."""

    @override
    def handle_connect(self, event: Request) -> None:
        super().handle_connect(event)
        if hasattr(self, "scope"):
            self.scope["state"][ABORT] = self.abort

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
