"""Complete the OpenAPI document of FastAPI by statuses, headers and tags."""

import re
from typing import Any
from urllib.parse import quote, unquote

import anyio
import anyio.to_thread
import orjson
from fastapi import FastAPI
from fastapi.routing import APIRoute
from starlette.types import Receive, Scope, Send
from typing_extensions import override

from station.api.agents import seat_of
from station.api.json_route import SLASH
from station.api.routes.routing import MEANINGS
from station.reports import Described, examples_of
from station.wire import PROBLEM_MEDIA_TYPE, Problem
from station.wire.protocol import KEY_HEADER, REPLAYED_HEADER

_REF = "#/components/schemas/"
_PROBLEM = {PROBLEM_MEDIA_TYPE: {"schema": {"$ref": f"{_REF}Problem"}}}
_OWN_ERRORS = ("HTTPValidationError", "ValidationError")

TAGS = {
    "health": "Whether the process lives and the loop runs; no token is needed.",
    "station": "The station at a glance.",
    "control": "Who holds control: a lease of one operator that others respect.",
    "access": "Named tokens, sessions of browsers, and tickets that open WebSockets.",
    "controllers": "Controllers: which can be loaded, which are, and which run.",
    "gains": "Run-time parameters of controllers, and named sets of them.",
    "set-points": "Set-points of running controllers, and the states that follow.",
    "bench": "Responses of joints to excitations, kept as runs, with their figures.",
    "rehearsals": "Forecasts of motions in a copy of the station, and paths.",
    "goals": "Trajectories and gripper goals: progress, result, cancelling.",
    "waypoint-paths": "Waypoint paths: captured, edited, kept, and played.",
    "plot-layouts": "Named layouts of the dashboard's plots.",
    "parameters": "The tree of parameters that controllers are loaded with (rosparam).",
    "robot": "The whole robot: joints, interfaces, claims, limits, transmissions.",
    "loop": "The control loop: rate, lateness, time per phase.",
    "robots": "Arms and grippers: state, model, services, recovery, simulated faults.",
    "simulation": "Time, reset and scene of a simulated robot.",
    "cameras": "Cameras that look at the robots, and their pictures.",
    "recordings": "Every cycle in MCAP files, and what was kept around incidents.",
    "experiments": "Many trials of a simulated copy of the station, beside its robot.",
    "lessons": "Exercises on the robot, checked on the student's own run.",
    "stop": "The latched stop, a software stop and no safety device.",
    "events": "What happened: who did what, when, from where, with what result.",
    "streams": "WebSocket streams; /api/v1/asyncapi.json describes their frames.",
}
"""Subject of the operations of each tag."""

PARAMETERS = {
    "name": ("Name of the controller.", "effort_group_position_controller"),
    "goal_id": ("Identifier of the goal, from the answer to its POST.", "1"),
    "arm_id": ("Name of the robot.", "panda"),
    "path": ("Names separated by `/`.", "effort_group_position_controller/joints"),
    "topic": ("Name of the topic.", "joint_states"),
    "frame": ("Frame of pose and Jacobians.", "flange"),
    "time": ("Station time [s]; the present when left out.", 12.5),
    "number": ("Number of the agent's request.", "5f0c81e09ab3"),
    "if-match": ("ETag of the gains that were read; refused when they changed.", "*"),
    "next": ("Page to show afterwards.", "/docs"),
}
"""Description and example of each parameter that routes do not describe."""

SERVERS = [{"url": "/", "description": "The server that this document comes from."}]
INFO = {
    "license": {"name": "Apache-2.0", "identifier": "Apache-2.0"},
    "contact": {"name": "The maintainers of the control station"},
}
_TEXT = {"schema": {"type": "string"}}
HEADERS = {
    "RequestId": {
        "description": "Name of the request, as given in the request or made up.",
        **_TEXT,
    },
    "ETag": {"description": "Entity tag of the gains, for If-Match.", **_TEXT},
    "WwwAuthenticate": {"description": "How to prove the access.", **_TEXT},
    "IdempotentReplayed": {
        "description": "`true` when the answer is that of an earlier request with the "
        "same `Idempotency-Key`; missing otherwise.",
        "schema": {"type": "string", "enum": ["true"]},
    },
    "Upgrade": {"description": "The protocol that is needed.", **_TEXT},
}
_OF_STATUS = {"401": ("WWW-Authenticate", "WwwAuthenticate"), "426": ("Upgrade",) * 2}

_WHOEVER_HOLDS_CONTROL = frozenset({
    f"/api/v1/{name}"
    for name in (
        "agents/requests/{number}",
        "login",
        "logout",
        "stop",
        "stream-tickets",
        "tokens",
        "tokens/{name}",
    )
})
"""Paths whose changes are allowed without control of the station."""


class StationApi(FastAPI):
    """A FastAPI application whose document describes every error as a problem document.

    Args:
        settings: Settings of FastAPI; separate routes serve the document's pages.
    """

    def __init__(self, **settings: Any) -> None:  # noqa: ANN401 - those of FastAPI
        super().__init__(openapi_url=None, docs_url=None, redoc_url=None, **settings)
        self._json = b""
        self._one_maker = anyio.CapacityLimiter(1)

    @override
    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        raw_path: bytes = scope.get("raw_path") or b""
        # A slash in a name would make another path of it. The routes decode it.
        if scope["type"] == "http" and SLASH in raw_path.decode("latin-1").upper():
            kept = re.sub(SLASH, quote(SLASH), raw_path.decode("latin-1"), flags=re.I)
            scope["path"] = unquote(kept)
        await super().__call__(scope, receive, send)

    def methods_by_path(self) -> dict[str, set[str]]:
        """Return the methods of each path, without making the document.

        Making the document takes half a second, in which other requests would wait.
        This is too long for an answer that only names paths.
        """
        found: dict[str, set[str]] = {}
        for route in self.routes:
            # The others are WebSockets and pages.
            if isinstance(route, APIRoute) and route.include_in_schema:
                found.setdefault(route.path_format, set()).update(route.methods or ())
        return found

    async def openapi_json(self) -> bytes:
        """Return the document as JSON; it is made once, in a worker thread.

        Making it takes half a second, in which the event loop must answer a stop.
        """
        if not self._json:
            self._json = await anyio.to_thread.run_sync(
                lambda: orjson.dumps(self.openapi()), limiter=self._one_maker
            )
        return self._json

    @override
    def openapi(self) -> dict[str, Any]:
        """Return the document, which is made once."""
        if self.openapi_schema is None:
            document = super().openapi()
            schemas = document["components"]["schemas"]
            problem = Problem.model_json_schema(ref_template=_REF + "{model}")
            schemas.update(problem.pop("$defs"))
            schemas["Problem"] = problem
            for name in _OWN_ERRORS:
                schemas.pop(name, None)
            _restore_examples(schemas)
            for schema in schemas.values():
                _require_tags(schema, schemas)
            document["components"]["headers"] = HEADERS
            document["servers"] = SERVERS
            document["info"] = {**document["info"], **INFO}
            document["tags"] = [
                {"name": name, "description": text} for name, text in TAGS.items()
            ]
            for path, methods in document["paths"].items():
                for method, operation in methods.items():
                    if method != "get" and path not in _WHOEVER_HOLDS_CONTROL:
                        locked = {"description": MEANINGS[423]}
                        operation["responses"].setdefault("423", locked)
                    seat = seat_of(method, operation)
                    if seat is not None:
                        operation["x-agent"] = seat
                    _complete(path, operation)
        return super().openapi()


def _restore_examples(schemas: dict[str, dict[str, Any]]) -> None:
    """Put the nulls back into examples, which the framework leaves out."""
    kinds: list[type[object]] = [Described]
    for kind in kinds:
        kinds += kind.__subclasses__()
        schema = schemas.get(kind.__name__, {})
        if "examples" in schema:
            schema["examples"] = examples_of(kind.__doc__)


def _require_tags(schema: object, schemas: dict[str, dict[str, Any]]) -> None:
    """Require the tag that distinguishes the members of a union.

    Requests must have the tag. If the document did not require it, an object could fit
    two members, but `oneOf` demands that it fits one.
    """
    if isinstance(schema, list):
        for each in schema:
            _require_tags(each, schemas)
    if not isinstance(schema, dict):
        return
    union = schema.get("discriminator")
    if isinstance(union, dict) and isinstance(union.get("mapping"), dict):
        for reference in union["mapping"].values():
            member = schemas[reference.removeprefix(_REF)]
            required = member.setdefault("required", [])
            if union["propertyName"] not in required:
                required.insert(0, union["propertyName"])
    for each in schema.values():
        _require_tags(each, schemas)


def _complete(path: str, operation: dict[str, Any]) -> None:
    operation.setdefault("security", [])  # an empty list means that no token is needed
    # The section "Raises" is for readers of the code; users see the responses.
    operation["description"] = operation["description"].partition("\n\nRaises:")[0]
    for parameter in operation.get("parameters", []):
        known = PARAMETERS.get(parameter["name"])
        if known is not None and "description" not in parameter:
            parameter["description"] = known[0]
            parameter.setdefault("example", known[1])
    for status, response in operation["responses"].items():
        if status >= "4":
            response["content"] = _PROBLEM
        named = {"X-Request-ID": "RequestId"}
        if status in _OF_STATUS:
            header, component = _OF_STATUS[status]
            named[header] = component
        if status == "200" and path.endswith("/{name}/gains"):
            named["ETag"] = "ETag"
        names = {each["name"].lower() for each in operation.get("parameters", [])}
        if KEY_HEADER.lower() in names:
            named[REPLAYED_HEADER] = "IdempotentReplayed"
        response["headers"] = {
            header: {"$ref": f"#/components/headers/{component}"}
            for header, component in named.items()
        }
