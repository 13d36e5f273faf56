"""Parts of every answer, request and stream: names, problems, frames, close codes."""

from typing import Final, Literal

from pydantic import Field, JsonValue

from station.wire.base import ReadT, ResponseModel, reader_of

PREFIX: Final = "/api/v1"
"""Path below which the API answers."""
LEASE_HEADER: Final = "X-Control-Lease"
"""Header of a change: the lease of control under which the client makes it."""
KEY_HEADER: Final = "Idempotency-Key"
"""Header of a change: its key. Changes with the same key are carried out once."""
CLOCK_HEADER: Final = "X-Station-Clock"
"""Header of every answer: the station's wall time [s since 1970]."""
REHEARSAL_HEADER: Final = "X-Rehearsal"
"""Header of an answer: `advised` if the command should have been rehearsed."""
NOT_AFTER_HEADER: Final = "X-Not-After"
"""Header of a change: the latest time by `X-Station-Clock` at which it may begin."""
REPLAYED_HEADER: Final = "Idempotent-Replayed"
"""Header of an answer: `true` if it repeats the answer to an earlier request."""
MAX_BODY_BYTES: Final = 256 * 1024
"""Largest body of a request [bytes]. Parsing a larger JSON would hold the interpreter
lock, and with it the control loop, for too long."""
UPLOAD_PATH: Final = f"{PREFIX}/recordings/upload"
"""Path of the only request whose body is a file. The file goes to the disk unparsed,
and is then checked piece by piece."""
MAX_UPLOAD_BYTES: Final = 500_000_000
"""Largest file of an upload [bytes]: ten minutes of a Panda at 1 kHz."""


def largest_body(path: str) -> int:
    """Return the largest body of a request to a path [bytes]."""
    return MAX_UPLOAD_BYTES if path == UPLOAD_PATH else MAX_BODY_BYTES


PROBLEM_MEDIA_TYPE = "application/problem+json"


class FieldError(ResponseModel):
    """One fault of a request.

    Attributes:
        field: Place of the fault, e.g. `body/values/panda_joint1/p`.
        message: The problem, and the allowed values.
        value: The value refused, as text.
    """

    field: str
    message: str
    value: str = ""


class Problem(ResponseModel):
    """The reason for a refused request. A refusal changes nothing.

    Attributes:
        type: URI of the kind of problem.
        title: The kind of problem in words.
        status: The HTTP status.
        detail: The thing, its value, and the allowed values.
        code: Stable machine-readable name of the kind.
        remedy: Advice to the user.
        errors: Every single fault, when there are several or a field is at fault.
        details: The facts of `detail` as data, e.g. who holds the joints.

    Example:
        {"type": "urn:control-station:problem:controller_not_found", "title":
         "Controller not found", "status": 404, "detail": "No controller 'arm' is
         loaded; loaded are: none.", "code": "controller_not_found", "remedy": "Load it
         with POST /api/v1/controllers."}
    """

    type: str
    title: str
    status: int = Field(ge=400, le=599)
    detail: str
    code: str
    remedy: str
    errors: list[FieldError] | None = None
    details: dict[str, JsonValue] | None = None


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
        topic: Topic; `hello` for the first message.
        seq: Counts the frames of the stream. A gap means that this client was too slow
            and missed frames. With `rate=full`, `seq` is the number of the newest cycle
            in the batch.
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
            ValidationError: The payload does not fit the model.
        """
        return reader_of(model).validate_python({"stamp": self.stamp, **self.data})


class CommandError(ResponseModel):
    """The reason for a refused set-point of a command stream.

    Attributes:
        code: Stable machine-readable name.
        detail: The thing, its value, and the allowed values.
        remedy: Advice to the user.
    """

    code: str
    detail: str
    remedy: str


class CommandCounts(ResponseModel):
    """Report to the sender of a command stream, twice a second at most.

    Attributes:
        received: Set-points that have come, 0 or more.
        applied: Those that a cycle has picked up, 0 or more.
        superseded: Those that a newer one replaced before a cycle came, 0 or more.
        refused: Those that were malformed or not possible, 0 or more.
        pending: Those that wait for a cycle, 0 to 2.
        cycle: Number of the last cycle, 0 or more.
        epoch: Present epoch, 1 or more.
        error: Why the last refused set-point was refused; null when none was.
    """

    received: int
    applied: int
    superseded: int
    refused: int
    pending: int
    cycle: int
    epoch: int
    error: CommandError | None = None
