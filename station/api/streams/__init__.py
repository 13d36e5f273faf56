"""WebSocket streams: what there is to see, made once, sent to whoever keeps up."""

from station.api.streams.broadcaster import Broadcaster
from station.api.streams.request import StreamRequest, StreamRequestError

__all__ = ["Broadcaster", "StreamRequest", "StreamRequestError"]
