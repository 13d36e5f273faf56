"""Errors of the command line, and reports of all errors with verbs as remedies."""

import json
import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from station.cli.output import say_progress
from station.core.errors import StationError, show
from station.core.installation import missing_extra

_ROUTE = r"(?:GET|POST|PUT|PATCH|DELETE) /"
_ASIDE = re.compile(rf"\s*\({_ROUTE}[^)]*\)|:\s*{_ROUTE}\S*(?=\.$)")
_SENTENCES = re.compile(r"(?<=[.!?])\s+(?=[A-Z])")

REMEDIES: Mapping[str, str] = {
    "agent_request_not_found": "`station agents list` lists them.",
    "bench_run_not_found": "`station bench list` lists the runs.",
    "certificate_not_found": "`station rehearse --certificate` gives a new one.",
    "certificate_void": "`station rehearse --certificate` gives a new one.",
    "control_held": "`station control show` says who holds control.",
    "control_not_held": "`station control take` takes it.",
    "controller_not_found": "`station list_controllers` lists the loaded ones.",
    "controller_state": "`station switch_controllers` starts and stops controllers.",
    "controller_type_not_found": "`station list_controller_types` lists the types.",
    "experiment_not_found": "`station experiments list` lists the experiments.",
    "experiment_running": "`station experiments cancel` ends one.",
    "gain_set_not_found": "`station gains list` lists the gain sets.",
    "gains_changed": "`station gains show` has the present ones.",
    "invalid_gain": "`station gains show` has names and ranges.",
    "lesson_not_found": "`station lesson list` lists the lessons.",
    "no_sample": "Start the controller: `station start`.",
    "parameter_not_found": "`station parameters get` has the whole tree.",
    "recording_not_found": "`station record list` and `station incidents` list them.",
    "rehearsal_needed": "`station rehearse --certificate` gives one.",
    "resource_conflict": "`station switch_controllers` stops and starts at once.",
    "saved_scene_not_found": "`station scene saved` lists the scenes.",
    "service_not_found": "`station robot` with an arm's name lists the services.",
    "simulation_refused": "`station pause` and `station resume` change that.",
    "stopped": "`station release` releases the stop, and `station release --arm` "
    "allows motion.",
    "token_not_found": "`station token list` lists the named tokens.",
}
"""The verb that helps with an error, by the code of the error."""


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


def report(failure: Failure, *, as_json: bool) -> None:
    """Write an error and its remedy to stderr."""
    if as_json:
        sys.stderr.write(json.dumps(failure.as_problem()) + "\n")
        return
    say_progress(f"error: {failure.detail}")
    remedy = for_terminal(failure.code, failure.remedy)
    if remedy:
        say_progress(remedy)


def failure_of(
    error: Exception, typed: Mapping[str, str] = MappingProxyType({})
) -> Failure | None:
    """Return the report of an expected error; None for a defect of the program.

    Args:
        error: The error.
        typed: What a user types for a field of a request, by the field's name.
    """
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
        return _failure_of_api(error, typed)
    if "ValidationError" in names:
        return _failure_of_validation(error, typed)
    return None


def _failure_of_missing(error: ModuleNotFoundError) -> Failure | None:
    """Return the report of a missing package of an extra; None for others."""
    missing = missing_extra(error)
    return None if missing is None else failure_of(missing)


def _failure_of_api(error: Any, typed: Mapping[str, str]) -> Failure:  # noqa: ANN401 - station.client.ApiError
    errors = [e.model_dump() for e in error.errors]
    lines = [_line(e, typed) for e in errors]
    if error.code == "invalid_request" and lines:
        # The station's words name the first of these fields as a request has it.
        return Failure(
            error.code, f"{'; '.join(lines)}.", _NOTHING_CHANGED, errors=errors
        )
    hints = [
        line
        for each, line in zip(errors, lines, strict=True)
        if each["message"] not in error.detail
    ]
    detail = "\n  ".join([error.detail, *hints])
    return Failure(error.code, detail, error.remedy, errors=errors)


def _line(error: dict[str, str], typed: Mapping[str, str]) -> str:
    name = typed_name(error["field"].split("/"), typed)
    value = f" (it is {error['value']})" if error["value"] else ""
    return f"{name}: {error['message']}{value}"


def typed_name(field: Sequence[str | int], typed: Mapping[str, str]) -> str:
    """Return a field of a request as the user typed it.

    Args:
        field: Path of the field in the request.
        typed: What a user types for a field, by the field's name.
    """
    parts = [str(part) for part in field]
    if len(parts) > 1 and parts[0] in _PARTS_OF_REQUESTS:
        del parts[0]
    word = typed.get(parts[0])
    rest = [part for part in parts[1:] if part not in _JSON_TYPES]
    if word is None:
        is_item = len(rest) == 1 and rest[0].isdecimal()
        return parts[0] if is_item else "/".join([parts[0], *rest])
    if "=" in word and rest:  # KEY=VALUE
        return "/".join(rest)
    if rest and rest[0].isdecimal() and not word.startswith("-"):
        return f"{word} number {int(rest[0]) + 1}"
    return "/".join([word, *(part for part in rest if not part.isdecimal())])


def explain_fields(
    error: Any,  # noqa: ANN401 - pydantic's
    typed: Mapping[str, str],
    kind: str | None = None,
) -> list[str]:
    """Return for each wrong field of a request its name, value and what is allowed.

    Args:
        error: The `ValidationError` of pydantic.
        typed: What a user types for a field, by the field's name.
        kind: The chosen one of several kinds of the request, which a path begins with.
    """
    from station.wire.validation_words import explain

    lines: dict[str, str] = {}
    for each in error.errors(include_url=False):
        place = each["loc"][1:] if each["loc"][:1] == (kind,) else each["loc"]
        name = typed_name(place or ("the request",), typed)
        line = f"{name}: {explain(each['type'], each.get('ctx', {}))}"
        value = each["input"]
        if each["type"] != "missing" and not isinstance(value, Mapping):
            line = f"{line} (it is {show(value)})"
        # A value of several possible types has an error for each type.
        lines.setdefault(name, line)
    return list(lines.values())


def _failure_of_validation(error: Any, typed: Mapping[str, str]) -> Failure:  # noqa: ANN401 - pydantic's
    lines = explain_fields(error, typed)
    detail = f"{'; '.join(lines)}."
    if not _is_request(error.title):
        return Failure(
            "unexpected_answer",
            f"The station's answer is not understood ({error.title}): {detail}",
            "Use the command line of the station's own version.",
            errors=lines,
        )
    return Failure("invalid_request", detail, _NOTHING_SENT, errors=lines)


def _is_request(title: str) -> bool:
    """Return whether a request, or a part of one, has the model of that name."""
    from station.wire import RequestModel

    kinds: list[type] = [RequestModel]
    for kind in kinds:
        kinds += kind.__subclasses__()
    return title in {kind.__name__ for kind in kinds}


_PARTS_OF_REQUESTS = frozenset({"body", "query", "path", "header"})
_JSON_TYPES = frozenset({"dict", "list", "float", "int", "str", "bool", "nullable"})
"""Names that pydantic adds to the path of a value that may have several types."""
_NOTHING_SENT = "Nothing was sent. Correct the value and try again."
_NOTHING_CHANGED = "Nothing changed. Correct the value and try again."


def for_terminal(code: str, remedy: str) -> str:
    """Return a remedy of the API as a person at a terminal can follow it.

    Args:
        code: Code of the error.
        remedy: The remedy. A sentence about a route is replaced by the verb for the
            code, or left out where no verb does it.
    """
    sentences = [_ASIDE.sub("", each) for each in _SENTENCES.split(remedy)]
    kept = [each for each in sentences if not re.search(_ROUTE, each)]
    if re.search(_ROUTE, remedy) and code in REMEDIES:
        kept.append(REMEDIES[code])
    return " ".join(kept)
