"""Errors of the client.

```
ApiError                       the station refused; has reason and remedy
├── EmptyNameError             the name of a thing is empty; nothing was sent
├── NotFiniteError             a number of a request is not finite; nothing was sent
├── MotionError                a motion or a goal did not reach its aim
├── StationUnreachableError    no answer at all
└── StreamTimeoutError         no such frame came in time
```
"""

from collections.abc import Sequence

from pydantic import ValidationError
from typing_extensions import override

from station.wire import FieldError, Problem


class ApiError(Exception):
    """The station refused a request, and nothing has changed.

    Attributes:
        status: HTTP status, or close code of a stream; 0 when there was no answer.
        code: Stable machine-readable name of the kind of failure.
        detail: The thing, its value, and the allowed values.
        remedy: Advice to the user.
        errors: Every single fault of the request.
        details: The facts of `detail` as data.
    """

    def __init__(
        self,
        detail: str,
        *,
        status: int,
        code: str,
        remedy: str = "",
        errors: Sequence[FieldError] = (),
        details: dict[str, object] | None = None,
    ) -> None:
        super().__init__(detail)
        self.status = status
        self.code = code
        self.detail = detail
        self.remedy = remedy
        self.errors = list(errors)
        self.details = dict(details or {})

    @override
    def __str__(self) -> str:
        """Return detail and remedy."""
        return f"{self.detail} {self.remedy}".strip()

    @classmethod
    def from_body(cls, status: int, body: bytes) -> "ApiError":
        """Build the error from an answer's status and body.

        An answer that is not a problem document, e.g. from a proxy, is quoted as it is.
        """
        try:
            problem = Problem.model_validate_json(body)
        except ValidationError:
            text = body[:200].decode(errors="replace")
            return cls(
                f"The server answered {status}, not as a station does: {text!r}.",
                status=status,
                code="not_a_station",
                remedy="Check that the URL is a station's.",
            )
        return cls(
            problem.detail,
            status=status,
            code=problem.code,
            remedy=problem.remedy,
            errors=problem.errors or (),
            details=dict(problem.details or {}),
        )


class StationUnreachableError(ApiError):
    """The station does not answer: it is not running, or not at that address."""

    def __init__(self, url: str, cause: Exception) -> None:
        reason = str(cause) or type(cause).__name__
        super().__init__(
            f"No answer from the station at {url}: {reason}.",
            status=0,
            code="unreachable",
            remedy=(
                "Give the station's certificate, or that of its authority: `--ca FILE` "
                "or `ca=`; the URL must have a name that is in it."
                if "CERTIFICATE_VERIFY_FAILED" in reason
                else "Check that it is running there (`station run`) and try again."
            ),
        )


class NotFiniteError(ApiError, ValueError):
    """A number of a request is not finite, which JSON cannot write."""

    def __init__(self, field: str, value: float) -> None:
        super().__init__(
            f"{field} is {value}; it must be a finite number.",
            status=0,
            code="invalid_request",
            remedy="Nothing was sent. Correct the value and try again.",
        )


class EmptyNameError(ApiError, ValueError):
    """The name of the thing that a request is about is empty."""

    def __init__(self) -> None:
        super().__init__(
            "The name is empty; it must have at least 1 character.",
            status=0,
            code="invalid_request",
            remedy="Nothing was sent. Give the name and try again.",
        )


class MotionError(ApiError):
    """A motion or a goal did not reach its aim, or not in time."""

    def __init__(self, detail: str, remedy: str = "") -> None:
        super().__init__(detail, status=0, code="motion_failed", remedy=remedy)


class StreamTimeoutError(ApiError, TimeoutError):
    """The expected frame did not come in time."""

    def __init__(self, topic: str, timeout: float | None) -> None:
        within = "before it was closed" if timeout is None else f"within {timeout:g} s"
        super().__init__(
            f"The stream '{topic}' had no such frame {within}.",
            status=0,
            code="stream_timeout",
            remedy="Wait longer, or look whether the loop runs: `station echo loop`.",
        )
