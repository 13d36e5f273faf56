"""WebSocket streams: each frame is made once and sent to all clients that asked."""

from station.api.streams.broadcaster import Broadcaster
from station.api.streams.request import StreamRequest, StreamRequestError

__all__ = ["Broadcaster", "StreamRequest", "StreamRequestError"]
