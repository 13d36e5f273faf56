"""WebSocket streams: each frame is made once and sent to all clients that want it."""

from station.api.streams.broadcaster import Broadcaster as Broadcaster
from station.api.streams.request import (
    StreamRequest as StreamRequest,
    StreamRequestError as StreamRequestError,
)
