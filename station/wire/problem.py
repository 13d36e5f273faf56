"""Wire models of a refusal (RFC 9457, application/problem+json)."""

from pydantic import Field, JsonValue

from station.wire.base import ResponseModel

PROBLEM_MEDIA_TYPE = "application/problem+json"


class FieldError(ResponseModel):
    """One thing that is wrong with a request.

    Attributes:
        field: Where, e.g. `body/values/panda_joint1/p`.
        message: What is wrong and what is allowed.
        value: The value refused, as text.
    """

    field: str
    message: str
    value: str = ""


class Problem(ResponseModel):
    """Why a request was refused. A refusal changes nothing.

    Attributes:
        type: URI of the kind of problem.
        title: The kind of problem in words.
        status: The HTTP status.
        detail: Which thing, its value, what is allowed.
        code: Stable machine-readable name of the kind.
        remedy: What to do about it.
        errors: Every single thing that is wrong, when there are several or fields.
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
