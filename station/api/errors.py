"""Turn exceptions into HTTP answers: every refusal is a problem document (RFC 9457)."""

import re
from collections.abc import Mapping, Sequence
from math import ceil

import orjson
from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.types import Receive, Scope, Send
from typing_extensions import override

from station.api.agents import (
    AgentRefusedError,
    AgentRequestDecidedError,
    AgentRequestNotFoundError,
    TooManyAgentRequestsError,
)
from station.api.cameras import CameraError, CameraNotFoundError
from station.api.control import ControlHeldError, ControlNotHeldError
from station.api.named_tokens import (
    TokenExistsError,
    TokenNotFoundError,
    TokensNotKeptError,
)
from station.core import errors
from station.events import AlarmNotFoundError
from station.rehearsal.rehearsals import AgentEnvelopeError, TooManyRehearsalsError
from station.trials.errors import (
    BenchRunNotFoundError,
    ExperimentError,
    ExperimentNotFoundError,
    ExperimentRunningError,
    ImpossibleRangeError,
    LessonNotFoundError,
    TooManyExperimentsError,
    UnknownParameterError,
)
from station.wire import PROBLEM_MEDIA_TYPE
from station.wire.validation_words import explain, explain_json

MAX_ERRORS = 20
PROBLEM_CODE = "problem_code"
"""Key in the scope's state for the code of a refusal, for the audit."""

STATUS: Mapping[type[errors.StationError], int] = {
    errors.StationError: 500,
    errors.HardwareInterfaceError: 422,
    errors.ResourceNotFoundError: 422,
    errors.HardwareComponentNotFoundError: 404,
    errors.HardwareComponentError: 409,
    errors.ParameterError: 422,
    errors.ConfigError: 422,
    errors.ControllerNotFoundError: 404,
    errors.ControllerTypeNotFoundError: 404,
    errors.ControllerLoadError: 422,
    errors.ControllerExistsError: 409,
    errors.ControllerModuleRefusedError: 403,
    errors.ControllerStateError: 409,
    errors.SwitchRefusedError: 409,
    errors.ResourceConflictError: 409,
    errors.SwitchTimeoutError: 504,
    errors.InvalidCommandError: 422,
    errors.ArmCommandError: 409,
    errors.ArmNotFoundError: 404,
    errors.ServiceNotFoundError: 404,
    errors.GripperNotFoundError: 404,
    errors.GripperCommandError: 409,
    errors.GripperLostError: 503,
    errors.CommandTimeoutError: 409,
    errors.InvalidTrajectoryError: 422,
    errors.GoalNotFoundError: 404,
    errors.InvalidGainError: 422,
    errors.GainsChangedError: 412,
    errors.ParameterNotFoundError: 404,
    errors.GainSetNotFoundError: 404,
    errors.GainSetError: 500,
    errors.PlotLayoutNotFoundError: 404,
    errors.PlotLayoutError: 500,
    errors.SavedSceneNotFoundError: 404,
    errors.SavedSceneError: 500,
    errors.SceneObjectNotFoundError: 404,
    errors.SceneRefusedError: 409,
    errors.WaypointPathNotFoundError: 404,
    errors.WaypointPathError: 500,
    errors.PathRefusedError: 409,
    errors.NothingToUndoError: 409,
    errors.RecordingNotFoundError: 404,
    errors.RecordingRefusedError: 409,
    errors.RecordingFileError: 500,
    errors.RecordingDamagedError: 409,
    errors.StaleEpochError: 409,
    errors.StoppedError: 423,
    errors.LoopError: 503,
    errors.SimulationError: 409,
    errors.RobotDescriptionError: 422,
    errors.RehearsalError: 503,
    errors.NoPathError: 409,
    errors.RehearsalNeededError: 428,
    errors.CertificateNotFoundError: 404,
    errors.CertificateVoidError: 412,
    ExperimentError: 409,
    ExperimentNotFoundError: 404,
    ExperimentRunningError: 409,
    UnknownParameterError: 422,
    ImpossibleRangeError: 422,
    TooManyExperimentsError: 422,
    AlarmNotFoundError: 404,
    TokenExistsError: 409,
    TokenNotFoundError: 404,
    TokensNotKeptError: 500,
    BenchRunNotFoundError: 404,
    CameraNotFoundError: 404,
    CameraError: 503,
    LessonNotFoundError: 404,
    AgentRefusedError: 403,
    AgentEnvelopeError: 403,
    TooManyAgentRequestsError: 429,
    TooManyRehearsalsError: 429,
    AgentRequestNotFoundError: 404,
    AgentRequestDecidedError: 409,
    ControlHeldError: 423,
    ControlNotHeldError: 409,
}
"""HTTP status of each class of error; other classes get that of their base class."""

ROUTES: Mapping[str, str] = {
    "bench_run_not_found": "GET /api/v1/bench-runs lists the runs.",
    "control_held": "GET /api/v1/control says who holds control.",
    "controller_not_found": "GET /api/v1/controllers lists the loaded ones.",
    "controller_state": "POST /api/v1/controllers/switch starts and stops controllers.",
    "controller_type_not_found": "GET /api/v1/controller-types lists the types.",
    "experiment_not_found": "GET /api/v1/experiments lists the experiments.",
    "experiment_running": "POST /api/v1/experiments/{name}/cancel ends one.",
    "gains_changed": "GET /api/v1/controllers/{name}/gains has the present ones.",
    "gain_set_not_found": "GET /api/v1/gain-sets lists the gain sets.",
    "goal_not_found": "GET /api/v1/controllers/{name}/goals lists the latest goals.",
    "lesson_not_found": "GET /api/v1/lessons lists the lessons.",
    "loop": "GET /api/v1/loop has the state of the control loop.",
    "invalid_gain": "GET /api/v1/controllers/{name}/gains has names and ranges.",
    "parameter_not_found": "GET /api/v1/parameters has the whole tree.",
    "recording_not_found": "GET /api/v1/recordings and /api/v1/incidents list them.",
    "resource_conflict": "POST /api/v1/controllers/switch stops and starts at once.",
    "service_not_found": "GET /api/v1/robots/{arm_id}/services lists the services.",
    "simulation_refused": "PATCH /api/v1/simulation pauses and resumes it.",
    "saved_scene_not_found": "GET /api/v1/scenes lists the scenes.",
    "plot_layout_not_found": "GET /api/v1/plot-layouts lists the layouts.",
    "waypoint_path_not_found": "GET /api/v1/waypoint-paths lists the paths.",
    "token_not_found": "GET /api/v1/tokens lists the named tokens.",
    "rehearsal_needed": "POST /api/v1/rehearse with `certificate: true` gives one.",
    "certificate_not_found": "POST /api/v1/rehearse gives a new one.",
    "certificate_void": "POST /api/v1/rehearse gives a new one.",
    "stale_epoch": "GET /api/v1/status has the present epoch.",
    "stopped": "POST /api/v1/stop/release releases the stop, and once more with "
    '{"arm": true} allows motion.',
}
"""The route that helps with an error, by the error's code, because the core knows no
routes."""

HTTP_REMEDIES: Mapping[int, str] = {
    400: "Send a JSON body as /docs describes it.",
    404: "/docs has all routes.",
    405: "Use one of the methods in the Allow header; see /docs.",
}


class ProblemResponse(Response):
    """An answer with a problem document; notes its code in the scope for the audit.

    Args:
        code: Stable machine-readable name.
        content: The document.
        status: HTTP status.
        headers: Extra response headers.
    """

    def __init__(
        self, code: str, content: bytes, status: int, headers: Mapping[str, str]
    ) -> None:
        super().__init__(content, status, dict(headers), PROBLEM_MEDIA_TYPE)
        self.code = code

    @override
    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        scope.setdefault("state", {})[PROBLEM_CODE] = self.code
        await super().__call__(scope, receive, send)


class ProblemError(HTTPException):
    """A refusal that the API itself decides on.

    It is an HTTPException, because the framework passes only these on while it reads a
    body.

    Args:
        status: HTTP status.
        code: Stable machine-readable name.
        detail: The thing, its value, and the allowed values.
        remedy: Advice to the user.
        headers: Extra response headers.
    """

    def __init__(
        self,
        status: int,
        code: str,
        detail: str,
        remedy: str,
        headers: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__(status, detail, headers)
        self.code = code
        self.remedy = remedy

    def response(self) -> Response:
        """Return the problem document of this refusal."""
        return problem_response(
            self.status_code,
            self.code,
            self.detail,
            self.remedy,
            headers=self.headers,
        )


def problem_response(
    status: int,
    code: str,
    detail: str,
    remedy: str,
    *,
    field_errors: Sequence[Mapping[str, str]] = (),
    details: Mapping[str, object] | None = None,
    headers: Mapping[str, str] | None = None,
) -> Response:
    """Return an answer with a problem document, with null for non-finite numbers."""
    body: dict[str, object] = {
        "type": f"urn:control-station:problem:{code}",
        "title": code.replace("_", " ").capitalize(),
        "status": status,
        "detail": detail,
        "code": code,
        "remedy": remedy,
    }
    if field_errors:
        body["errors"] = list(field_errors)
    if details:
        body["details"] = dict(details)
    content = orjson.dumps(body, default=str, option=orjson.OPT_NON_STR_KEYS)
    return ProblemResponse(code, content, status, headers or {})


def status_of(kind: type[errors.StationError]) -> int:
    """Return the HTTP status for an error of that class."""
    return next(STATUS[c] for c in kind.__mro__ if c in STATUS)


def station_error_response(error: errors.StationError) -> Response:
    """Return the problem document of a refusal by the station, with its own words."""
    details = dict(error.details)
    listed = details.pop("errors", None)
    field_errors = [
        {str(key): str(value) for key, value in item.items()}
        for item in (listed if isinstance(listed, list) else [])
        if isinstance(item, Mapping)
    ]
    wait = details.get("retry_after")
    headers = {"Retry-After": f"{ceil(wait)}"} if isinstance(wait, float) else {}
    return problem_response(
        status_of(type(error)),
        error.code,
        error.message,
        _remedy(error),
        field_errors=field_errors,
        details=details,
        headers=headers,
    )


def _remedy(error: errors.StationError) -> str:
    """Return the error's remedy, and the route that carries out the remedy."""
    parts = (error.remedy, ROUTES.get(error.code), _configuration_line(error))
    return " ".join(part for part in parts if part) or "See the detail."


def _configuration_line(error: errors.StationError) -> str | None:
    """Return the line of the configuration that would allow the refused request."""
    if not isinstance(error, errors.ControllerModuleRefusedError):
        return None
    listed = error.details.get("allowed")
    known = listed if isinstance(listed, list) else []
    line = ", ".join(str(each) for each in (*known, error.details.get("module")))
    return f"In the configuration, under 'station': controller_modules: [{line}]"


def validation_response(error: RequestValidationError) -> Response:
    """Return the problem document of a malformed request, with all wrong fields."""
    found = error.errors()
    fields = [
        {
            "field": "/".join(str(part) for part in item["loc"]),
            "message": explain(item["type"], item.get("ctx", {})),
            "value": "" if item["type"] == "missing" else _shown(item.get("input")),
        }
        for item in found[:MAX_ERRORS]
    ]
    if found[0]["type"] == "json_invalid":
        position = found[0]["loc"][-1]
        why = str(found[0].get("ctx", {}).get("error", ""))
        fields[0] = {
            "field": "body",
            "message": explain_json(error.body, int(position), why),
            "value": "",
        }
    first = fields[0]
    value = f" (it is {first['value']})" if first["value"] else ""
    others = {1: "", 2: " There is one more error."}
    more = others.get(len(found), f" There are {len(found) - 1} more errors.")
    return problem_response(
        422,
        "invalid_request",
        f"{first['field']}: {first['message']}{value}.{more}",
        "Correct the fields named in 'errors'; /docs has the shapes. Nothing changed.",
        field_errors=fields,
    )


def _shown(value: object) -> str:
    if value is None:
        return "null"
    if isinstance(value, (str, int, float)):
        text = repr(value) if not isinstance(value, int) else _digits(value)
        return text if len(text) <= 80 else text[:77] + "..."
    return ""


def _digits(value: int) -> str:
    # `repr` of a huge integer is slow, and raises an error beyond 4300 digits.
    return repr(value) if value.bit_length() <= 256 else "an enormous integer"


def add_error_handlers(app: FastAPI) -> None:
    """Make `app` answer every exception with a problem document."""

    @app.exception_handler(errors.StationError)
    async def _station(_: Request, error: errors.StationError) -> Response:
        return station_error_response(error)

    @app.exception_handler(ProblemError)
    async def _problem(_: Request, error: ProblemError) -> Response:
        return error.response()

    @app.exception_handler(RequestValidationError)
    async def _validation(_: Request, error: RequestValidationError) -> Response:
        return validation_response(error)

    @app.exception_handler(HTTPException)
    async def _http(request: Request, error: HTTPException) -> Response:
        return problem_response(
            error.status_code,
            _HTTP_CODES.get(error.status_code, "http_error"),
            f"{request.method} {request.url.path}: {error.detail}.",
            _http_remedy(request, error.status_code),
            headers=_allowed(request) if error.status_code == 405 else error.headers,
        )

    @app.exception_handler(Exception)
    async def _unexpected(request: Request, error: Exception) -> Response:
        # The framework raises the error again afterwards, so the server logs the
        # traceback.
        return problem_response(
            500,
            "internal_error",
            f"{request.method} {request.url.path} failed unexpectedly: "
            f"{type(error).__name__}.",
            "The station's log has the traceback; please report it.",
        )


def _allowed(request: Request) -> dict[str, str]:
    """Return the Allow header of a path, with the methods of all its routes.

    The framework only knows the methods of the first route that matches the path. A
    path without parameters, e.g. `/controllers/switch`, has only its own methods, not
    those of a controller of that name.
    """
    paths: dict[str, set[str]] = request.app.methods_by_path()
    if request.url.path in paths:
        return {"Allow": ", ".join(sorted(paths[request.url.path]))}
    methods: set[str] = set()
    for template, own in paths.items():
        rest = template.replace("{path}", "{topic}").split("{topic}")
        pattern = ".+".join(re.sub(r"\\{\w+\\}", "[^/]+", re.escape(p)) for p in rest)
        if re.fullmatch(pattern, request.url.path):
            methods |= own
    return {"Allow": ", ".join(sorted(methods))}


def _http_remedy(request: Request, status: int) -> str:
    """Return the remedy; for an unknown path it names similar paths."""
    remedy = HTTP_REMEDIES.get(status, "See /docs.")
    if status != 404:
        return remedy
    paths = [each for each in request.app.methods_by_path() if "{" not in each]
    return f"{errors.suggest(request.url.path, paths)} {remedy}"


_HTTP_CODES = {
    400: "bad_request",
    404: "route_not_found",
    405: "method_not_allowed",
    413: "body_too_large",
}
