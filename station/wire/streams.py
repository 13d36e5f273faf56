"""Wire models of WebSocket streams."""

from typing import Literal

from pydantic import Field, JsonValue

from station.wire.base import ReadT, ResponseModel, reader_of

CLOSE_GOING_AWAY = 1001
CLOSE_TRY_LATER = 1013
CLOSE_BAD_REQUEST = 4400
CLOSE_UNAUTHORIZED = 4401
CLOSE_FORBIDDEN = 4403
CLOSE_UNKNOWN_TOPIC = 4404
CLOSE_TOO_SLOW = 4408
CLOSE_CONTROL_HELD = 4423

StreamFormat = Literal["json", "msgpack"]


class StreamFrame(ResponseModel):
    """One message of a stream.

    Attributes:
        topic: What it is about; `hello` for the first one.
        seq: Counts the frames of the stream. A gap is frames this client was too slow
            for. With `rate=full` it is the number of the newest cycle in the batch.
        epoch: Epoch of the data.
        cycle: Number of the cycle of the data; with `rate=full` of the newest one.
        stamp: Station time of the data [s].
        boot_id: Changes when the station restarts. On the wire only in `hello`; the
            client repeats it in every frame.
        data: The payload.
    """

    topic: str
    seq: int
    epoch: int
    cycle: int = 0
    stamp: float
    boot_id: str = ""
    data: dict[str, JsonValue] = Field(default_factory=dict)

    def read(self, model: type[ReadT]) -> ReadT:
        """Return the payload as a wire model, e.g. `frame.read(JointStates).position`.

        Args:
            model: The model of the topic; the stream must have all its fields.

        Raises:
            ValidationError: The payload is another one.
        """
        return reader_of(model).validate_python({"stamp": self.stamp, **self.data})


class CommandError(ResponseModel):
    """Why a set-point of a command stream was refused.

    Attributes:
        code: Stable machine-readable name.
        detail: Which thing, its value, what is allowed.
        remedy: What to do.
    """

    code: str
    detail: str
    remedy: str


class CommandCounts(ResponseModel):
    """Counts that the sender of a command stream gets, twice a second at most.

    Attributes:
        received: Set-points that have come, 0 or more.
        applied: Those that a cycle has picked up, 0 or more.
        superseded: Those that a newer one replaced before a cycle came, 0 or more.
        refused: Those that were malformed or not possible, 0 or more.
        pending: Those that wait for a cycle, 0 to 2.
        cycle: Number of the last cycle, 0 or more.
        epoch: Present epoch, 1 or more.
        error: Why the last refused one was refused; null when none was.
    """

    received: int
    applied: int
    superseded: int
    refused: int
    pending: int
    cycle: int
    epoch: int
    error: CommandError | None = None
