"""The audit: every change in words, with its caller, address, time and result."""

import re
import time
from collections.abc import Callable

from starlette.datastructures import Headers
from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from station.api.auth import Access, Role
from station.api.errors import PROBLEM_CODE
from station.api.services import services_of
from station.core.control.switching import SwitchResult
from station.events import EventKind, EventLog, Origin, Severity
from station.events.repeats import Repeats
from station.web.request_id import present_request_id
from station.wire.protocol import LEASE_HEADER, PREFIX, REPLAYED_HEADER

WHO = "who"
"""Key in the scope's state for the proved identity of a request's caller."""
_OF_AGENT = "is_of_agent"
_PREVIEW = "is_preview"
_MARK = "mark"
_READS = frozenset({"GET", "HEAD", "OPTIONS"})
# These requests change nothing of the station; logins have events of their own.
_UNREMARKABLE = frozenset({"/login", "/logout", "/stream-tickets"})
# A heartbeat comes every few seconds for hours. An offer to hand control over has an
# event of its own.
_HEARTBEAT = "PATCH /control"


def note_access(connection: HTTPConnection, access: Access) -> None:
    """Note the caller of a request or a WebSocket.

    Many people may share a token. The holder of control has given a name, which events
    of changes also contain.

    Args:
        connection: The request.
        access: Rights that the token of the request has proved.
    """
    who = access.name
    if connection.scope.get("method") not in _READS:
        control = services_of(connection).control
        who = control.name_of(access, connection.headers.get(LEASE_HEADER))
    state = connection.scope.setdefault("state", {})
    state[WHO] = who
    state[_OF_AGENT] = access.role is Role.AGENT


def note_preview(connection: HTTPConnection) -> None:
    """Note that a request is a preview, which is not recorded as an event."""
    connection.scope.setdefault("state", {})[_PREVIEW] = True


def note_mark(connection: HTTPConnection, text: str) -> None:
    """Note the mark that plots show for a request."""
    connection.scope.setdefault("state", {})[_MARK] = text


def origin_of(connection: HTTPConnection) -> Origin:
    """Return the proved identity of the caller of a request or WebSocket."""
    client = connection.client
    return Origin(
        who=connection.scope.get("state", {}).get(WHO, ""),
        where="" if client is None else client.host,
        request_id=present_request_id() or "",
    )


class Audit:
    """Records every requested change, carried out or refused, and all reads by agents.

    It runs before the guard, so that it also records requests from forbidden hosts and
    origins. Repeated set-points are counted, see `Repeats`.

    Args:
        app: The application.
        repeats: Takes the events.
    """

    def __init__(self, app: ASGIApp, repeats: Repeats) -> None:
        self._app = app
        self._repeats = repeats

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, and record its end."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        scope.setdefault("state", {})
        status = 0
        is_repeated = False

        async def send_and_note(message: Message) -> None:
            nonlocal status, is_repeated
            if message["type"] == "http.response.start":
                status = message["status"]
                is_repeated = REPLAYED_HEADER in Headers(raw=message.get("headers", []))
            await send(message)

        try:
            await self._app(scope, receive, send_and_note)
        finally:
            self._record(scope, status, is_repeated=is_repeated)

    def _record(self, scope: Scope, status: int, *, is_repeated: bool) -> None:
        # Reads of people are not recorded; every call of an agent is.
        is_of_agent = bool(scope["state"].get(_OF_AGENT))
        if scope["method"] in _READS and not is_of_agent:
            return
        path = scope["path"].removeprefix(PREFIX)
        is_done = 200 <= status < 400
        if scope["state"].get(_PREVIEW) or (
            is_done and path in _UNREMARKABLE and not is_of_agent
        ):
            return
        origin = origin_of(HTTPConnection(scope))
        what = asked = f"{scope['method']} {path}"
        if is_done and what == _HEARTBEAT:
            return
        code = scope["state"].get(PROBLEM_CODE, "")
        result = f"{status} {code}".strip() if status else "no answer"
        if not is_done and not origin.who:
            # A client that guesses tokens can use any paths, so paths must not
            # distinguish its events.
            what = scope["method"]
        who = origin.who or "a stranger"
        text = words_of(asked, who, result, is_done=is_done)
        if is_repeated:
            text = f"{asked} of {who} got its first answer again."
            result = f"{result} again"
        mark = (scope["state"].get(_MARK) or mark_of(asked)) if is_done else None
        self._repeats.record(
            EventKind.REQUEST,
            text,
            details={} if mark is None else {"mark": mark},
            severity=Severity.INFO if is_done else _severity(status),
            what=what,
            result=result,
            origin=origin,
            free=1 if is_done and path.endswith("/command") else 10,
        )


def _severity(status: int) -> Severity:
    return Severity.ERROR if status >= 500 or not status else Severity.WARNING


class EventRecorder:
    """Records events of the API in the log, and counts repeats.

    Args:
        log: The event log.
        now: Monotonic clock [s].

    Attributes:
        log: As given.
        repeats: Counts repeated events.
    """

    def __init__(
        self, log: EventLog, now: Callable[[], float] = time.monotonic
    ) -> None:
        self.log = log
        self.repeats = Repeats(log, now)

    def failed_login(self, connection: HTTPConnection) -> None:
        """Record that a request or a WebSocket showed a wrong token."""
        self.repeats.record(
            EventKind.LOGIN_FAILED,
            "Somebody showed a token that this station does not know.",
            severity=Severity.WARNING,
            what=connection.scope["type"],
            result="401 unauthorized",
            origin=origin_of(connection),
            free=3,
        )

    def login(self, connection: HTTPConnection, access: Access, what: str) -> None:
        """Record that a browser has logged in or out.

        Args:
            connection: Request of the browser.
            access: Rights of the client.
            what: `login` or `logout`.
        """
        found = origin_of(connection)
        self.log.record(
            EventKind.LOGIN,
            f"A browser of {access.name} has made a {what}.",
            what=what,
            result=access.role.value,
            origin=Origin(access.name, found.where, found.request_id),
        )

    def switch(self, connection: HTTPConnection, result: SwitchResult) -> None:
        """Record how a switch ended.

        Args:
            connection: The request of the switch.
            result: Result of the switch.
        """
        names = [f"started {name}" for name in result.started]
        names += [f"stopped {name}" for name in result.stopped]
        names += [f"{name} failed: {why}" for name, why in result.failed.items()]
        self.log.record(
            EventKind.SWITCH,
            f"Switch {result.outcome.name.lower()}: {', '.join(names) or 'nothing'}.",
            severity=Severity.INFO if result.ok else Severity.WARNING,
            what="controllers",
            result=result.outcome.name.lower(),
            details={
                "started": result.started,
                "stopped": result.stopped,
                "failed": result.failed,
                "jump": result.jump,
                "cycle": result.cycle,
            },
            origin=origin_of(connection),
        )


# Method and route, verb for a refusal, verb for a success, and object. `*` matches a
# part of the path, to which `{0}` and `{1}` refer. The first matching route counts.
_DEEDS = (
    ("POST /stop", "stop", "stopped", "the robot"),
    ("POST /stop/release", "release", "released", "the stop, or allowed motion"),
    ("POST /controllers", "load", "loaded", "a controller"),
    ("DELETE /controllers/*", "unload", "unloaded", "{0}"),
    ("POST /controllers/switch", "switch", "switched", "controllers"),
    ("PATCH /controllers/*/gains", "change", "changed", "gains of {0}"),
    ("PUT /controllers/*/command", "command", "commanded", "{0}"),
    ("POST /controllers/*/(?:goals|trajectory)", "send", "sent", "{0} a goal"),
    ("DELETE /controllers/*/goals/*", "cancel", "cancelled", "a goal of {0}"),
    ("PATCH /gains", "change", "changed", "gains"),
    ("POST /(?:controllers/*/)?bench.*", "test", "tested", "a joint"),
    ("POST /gain-sets/undo", "take back", "took back", "the last change of gains"),
    ("PUT /gain-sets/*", "save", "saved", "the gain set {0}"),
    ("POST /gain-sets/*/apply", "apply", "applied", "the gain set {0}"),
    ("DELETE /gain-sets/*", "delete", "deleted", "the gain set {0}"),
    ("PUT /waypoint-paths/*", "save", "saved", "the waypoint path {0}"),
    ("DELETE /waypoint-paths/*", "delete", "deleted", "the waypoint path {0}"),
    ("POST /waypoint-paths/*/capture", "capture", "captured", "a waypoint of {0}"),
    ("POST /waypoint-paths/*/play", "play", "played", "the waypoint path {0}"),
    ("PATCH /playback", "change", "changed", "how a waypoint path plays"),
    ("DELETE /playback", "end", "ended", "a waypoint path"),
    ("PATCH /simulation", "change", "changed", "the pace of the simulation"),
    ("POST /simulation/step", "step", "stepped", "the simulation"),
    ("POST /simulation/reset", "reset", "reset", "the simulation"),
    ("POST /robots/(?:*/)?error_recovery", "recover", "recovered", "the robot"),
    ("POST /robots/*/guiding", "switch", "switched", "the guiding of {0}"),
    ("POST /robots/*/user_stop", "switch", "switched", "the user stop of {0}"),
    ("POST /robots/*/external_force", "push", "pushed", "{0}"),
    ("POST /robots/*/faults", "inject", "injected", "a fault into {0}"),
    ("DELETE /robots/*/faults", "end", "ended", "the faults of {0}"),
    ("PUT /robots/*/*", "set", "set", "{1} of {0}"),
    ("POST /robots/*/gripper/*", "command", "commanded", "the gripper of {0} to {1}"),
    ("PUT /plot-layouts/*", "save", "saved", "the layout {0}"),
    ("DELETE /plot-layouts/*", "delete", "deleted", "the layout {0}"),
    ("PUT /scene/*", "change", "changed", "the object {0}"),
    ("DELETE /scene/*", "remove", "removed", "the object {0}"),
    ("POST /rehearse", "rehearse", "rehearsed", "a motion"),
    ("POST /plan", "plan", "planned", "a motion"),
    ("POST /recordings/upload", "upload", "uploaded", "a recording"),
    ("POST /recordings", "begin", "began", "a recording"),
    ("POST /recordings/*/stop", "end", "ended", "the recording {0}"),
    ("POST /alarms/*/acknowledge", "acknowledge", "acknowledged", "an alarm"),
    ("POST /experiments", "begin", "began", "an experiment"),
    ("POST /experiments/*/cancel", "cancel", "cancelled", "the experiment {0}"),
    ("POST /experiments/*/apply", "apply", "applied", "the gains of experiment {0}"),
    ("(?:POST|PUT) /control(?:/.*)?", "take", "took", "control"),
    ("PATCH /control(?:/.*)?", "offer", "offered", "control"),
    ("DELETE /control(?:/.*)?", "give back", "gave back", "control"),
)
_MARKS = (
    ("PATCH /gains", "gains"),
    ("POST /gain-sets/undo", "gains undone"),
    ("POST /gain-sets/*/apply", "gain set {0}"),
    ("POST /experiments/*/apply", "gains of {0}"),
    ("POST /simulation/reset", "reset"),
    ("POST /robots/(?:*/)?error_recovery", "recovery"),
)
_PART = re.compile(r"(?<!\.)\*")


def _pattern(route: str) -> re.Pattern[str]:
    return re.compile(_PART.sub("([^/]+)", route))


_WORDS = [(_pattern(route), verb, past, thing) for route, verb, past, thing in _DEEDS]
_MARKED = [(_pattern(route), mark) for route, mark in _MARKS]


def words_of(what: str, who: str, result: str, *, is_done: bool) -> str:
    """Return a sentence about a request.

    Args:
        what: Method and route of the request.
        who: Person or program that sent the request.
        result: Status and code of the answer.
        is_done: Whether it was carried out.
    """
    for route, verb, past, thing in _WORDS:
        found = route.fullmatch(what)
        if found:
            named = thing.format(*found.groups())
            done, refused = f"{past} {named}", f"could not {verb} {named} ({result})"
            return f"{who} {done if is_done else refused}."
    ended = "was carried out" if is_done else f"was refused: {result}"
    return f"{what} of {who} {ended}."


def mark_of(what: str) -> str | None:
    """Return the mark in plots for a request that was carried out; None without one.

    Args:
        what: Method and route of the request.
    """
    for route, mark in _MARKED:
        found = route.fullmatch(what)
        if found:
            return mark.format(*found.groups())
    return None
