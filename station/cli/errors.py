"""Errors of the command line, and reports of errors of all kinds."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from station.core.errors import StationError
from station.core.installation import missing_extra


class UsageError(StationError, ValueError):
    """The command line is wrong, or asks for something that cannot be done."""

    code = "usage"


@dataclass(frozen=True, slots=True)
class Failure:
    """Failure of a verb, for people and for `--json`.

    Attributes:
        code: Stable name of the kind of failure.
        detail: The thing, its value, and the allowed values.
        remedy: Advice to the user; may be empty.
        is_usage: Whether the command line itself is wrong.
        errors: Every single fault, when there are several.
    """

    code: str
    detail: str
    remedy: str
    is_usage: bool = False
    errors: Sequence[object] = ()

    def as_problem(self) -> dict[str, object]:
        """Return the failure as JSON-compatible data."""
        data: dict[str, object] = {
            "code": self.code,
            "detail": self.detail,
            "remedy": self.remedy,
        }
        return {**data, "errors": list(self.errors)} if self.errors else data


def failure_of(error: Exception) -> Failure | None:
    """Return the report of an expected error; None for a defect of the program."""
    if isinstance(error, StationError):
        return Failure(
            error.code, error.message, error.remedy, isinstance(error, UsageError)
        )
    if isinstance(error, ModuleNotFoundError):
        return _failure_of_missing(error)
    # Errors of the client and of pydantic are recognised by their names, because
    # importing these packages takes longer than most verbs.
    names = {kind.__name__ for kind in type(error).__mro__}
    if "ApiError" in names:
        return _failure_of_api(error)
    if "ValidationError" in names:
        return _failure_of_validation(error)
    return None


def _failure_of_missing(error: ModuleNotFoundError) -> Failure | None:
    """Return the report of a missing package of an extra; None for others."""
    missing = missing_extra(error)
    return None if missing is None else failure_of(missing)


def _failure_of_api(error: Any) -> Failure:  # noqa: ANN401 - station.client.ApiError
    errors = [e.model_dump() for e in error.errors]
    detail = "\n  ".join([error.detail, *(_line(e) for e in errors)])
    return Failure(error.code, detail, error.remedy, errors=errors)


def _line(error: dict[str, object]) -> str:
    return ": ".join(str(value) for value in error.values() if value)


def _failure_of_validation(error: Any) -> Failure:  # noqa: ANN401 - pydantic's
    found = error.errors(include_url=False, include_context=False)
    lines = [
        f"{'.'.join(str(part) for part in e['loc'])} is {e['input']!r}: {e['msg']}"
        for e in found
    ]
    detail = "; ".join(lines) + "."
    if not error.title.endswith(("Request", "Patch")):
        return Failure(
            "unexpected_answer",
            f"The station's answer is not understood ({error.title}): {detail}",
            "Use the command line of the station's own version.",
            errors=lines,
        )
    remedy = "Nothing was sent. Correct the value and try again."
    return Failure("invalid_request", detail, remedy, errors=lines)
