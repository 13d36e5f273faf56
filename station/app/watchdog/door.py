"""The watchdog's own HTTP listener: whether the station is ready, the stop, incidents.

A few hundred bytes of HTTP/1.1 over non-blocking sockets, without a library: the
process must start at once, stay small and never wait for a client.
"""

import hashlib
import json
import select
import socket
import time
from hmac import compare_digest
from typing import TYPE_CHECKING

from station.app.watchdog.watch import Watch, WatchdogSettings

if TYPE_CHECKING:
    from collections.abc import Callable

CONNECTIONS = 16
"""Most connections at once; the oldest is closed for a new one, which may be a stop."""
_REQUEST_TIME = 1.0
_MAX_REQUEST = 8192
_CONFIRM_TIME = 0.05
"""How long the answer to a stop waits for the loop to carry it out [s]."""
_REASONS = {
    200: "OK",
    400: "Bad Request",
    401: "Unauthorized",
    404: "Not Found",
    413: "Content Too Large",
    503: "Service Unavailable",
}


class _Connection:
    """One client: the bytes that it has sent, and its deadline."""

    def __init__(self, peer: socket.socket, deadline: float) -> None:
        self.peer = peer
        self.deadline = deadline
        self.received = b""
        self.confirm_by: float | None = None


class Door:
    """Serves `GET /ready`, `GET /incident` and `POST /stop` on a loopback socket.

    Args:
        listener: Listening, loopback.
        settings: The tokens of the station that are accepted, besides named ones.
        watch: Answers what the station does, and holds the arms on a stop.
    """

    def __init__(
        self, listener: socket.socket, settings: WatchdogSettings, watch: Watch
    ) -> None:
        self._listener = listener
        self._listener.settimeout(0.0)
        self._watch = watch
        self._roles = {
            settings.operator_token: "operator",
            settings.viewer_token: "viewer",
        }
        self._named: dict[str, tuple[str, float | None]] = {}
        self._connections: list[_Connection] = []

    def take_token(self, digest: str, role: str, expires: float | None) -> None:
        """Accept a named token of the station from now on, or forget it.

        Args:
            digest: SHA-256 of the token, hexadecimal.
            role: Role of a token; empty for a token that has ended.
            expires: Wall time when it ends [s since 1970]; None when it does not.
        """
        if role:
            self._named[digest] = (role, expires)
        else:
            self._named.pop(digest, None)

    def wait(self, timeout: float, others: list[int]) -> list[int]:
        """Wait until a client or one of the file descriptors `others` has something.

        Args:
            timeout: Longest wait [s].
            others: File descriptors that somebody else reads.

        Returns:
            Those of `others` that can be read.
        """
        waiting = [one for one in self._connections if one.confirm_by is None]
        sockets = [self._listener.fileno(), *(one.peer.fileno() for one in waiting)]
        ready, _, _ = select.select([*sockets, *others], [], [], timeout)
        return [one for one in ready if one in others]

    def serve(self, now: float) -> None:
        """Accept connections, read their bytes, and answer complete requests.

        Args:
            now: Monotonic time [s].
        """
        self._accept(now)
        for connection in list(self._connections):
            try:
                self._carry_on(connection, now)
            except OSError:
                self._drop(connection)  # the client is gone

    def close(self) -> None:
        """Close the listener and every connection."""
        for connection in list(self._connections):
            self._drop(connection)
        self._listener.close()

    def _accept(self, now: float) -> None:
        while True:
            try:
                peer, _ = self._listener.accept()
            except OSError:
                return  # nobody waits, or the client has given up already
            peer.settimeout(0.0)
            if len(self._connections) >= CONNECTIONS:
                self._drop(self._connections[0])
            self._connections.append(_Connection(peer, now + _REQUEST_TIME))

    def _drop(self, connection: _Connection) -> None:
        self._connections.remove(connection)
        connection.peer.close()

    def _carry_on(self, connection: _Connection, now: float) -> None:
        if connection.confirm_by is not None:
            self._confirm(connection, now)
            return
        try:
            data = connection.peer.recv(_MAX_REQUEST)
        except BlockingIOError:
            if now > connection.deadline:
                self._drop(connection)
            return
        connection.received += data
        request = _Request.parse(connection.received)
        if request is not None:
            self._dispatch(connection, request, now)
        elif len(connection.received) > _MAX_REQUEST:
            self._answer(connection, 413, _problem("too_large", "At most 8 KiB."))
        elif not data:
            self._drop(connection)

    def _dispatch(
        self, connection: _Connection, request: "_Request", now: float
    ) -> None:
        if request.line == "GET /ready":
            trouble = self._watch.trouble(now)
            ready: dict[str, object] = {
                "ready": True,
                "last_wake_up_age": self._watch.age(now),
            }
            if trouble is None:
                self._answer(connection, 200, ready)
            else:
                self._answer(connection, 503, _problem("not_ready", trouble))
            return
        role = self._role(request.token)
        handlers: dict[str, Callable[[], None]] = {
            "POST /stop": lambda: self._stop(connection, request, role or "", now),
            "GET /incident": lambda: self._tell_incident(connection),
        }
        handler = handlers.get(request.line)
        if role is None:
            detail = "A token of the station is needed: Authorization: Bearer …"
            self._answer(connection, 401, _problem("unauthorized", detail))
        elif handler is None:
            detail = "There are GET /ready, GET /incident and POST /stop."
            self._answer(connection, 404, _problem("not_found", detail))
        else:
            handler()

    def _role(self, token: bytes) -> str | None:
        found = None
        for known, role in self._roles.items():
            # All are compared, each in constant time: the time tells nothing.
            if compare_digest(known.encode(), token):
                found = found or role
        if found is not None:
            return found
        # Looking a hash of a secret up takes no time that tells anything of the secret.
        named = self._named.get(hashlib.sha256(token).hexdigest())
        if named is None or (named[1] is not None and time.time() >= named[1]):
            return None
        return named[0]

    def _tell_incident(self, connection: _Connection) -> None:
        incident = self._watch.incident
        if incident is None:
            problem = _problem("no_incident", "The loop has not stood still so far.")
            self._answer(connection, 404, problem)
        else:
            self._answer(connection, 200, incident.facts)

    def _stop(
        self, connection: _Connection, request: "_Request", role: str, now: float
    ) -> None:
        reason = request.reason() or "no reason given"
        self._watch.heartbeat.ask_stop(f"{reason} (the {role}, through the watchdog)")
        if self._watch.trouble(now) is not None:
            self._watch.hold(now)
        connection.confirm_by = now + _CONFIRM_TIME

    def _confirm(self, connection: _Connection, now: float) -> None:
        """Answer a stop once the loop has carried it out, or does not in time."""
        heartbeat = self._watch.heartbeat
        if not heartbeat.is_stop_asked:
            self._answer(
                connection, 200, _stopped("The loop has carried it out.", done=True)
            )
        elif now > (connection.confirm_by or 0.0):
            self._watch.hold(now)
            trouble = self._watch.trouble(now) or "The loop has not answered yet."
            detail = (
                f"{trouble} The stop is latched: a loop that comes back carries it out "
                "before it writes anything to the robot."
            )
            self._answer(connection, 200, _stopped(detail, done=False))

    def _answer(
        self, connection: _Connection, status: int, body: dict[str, object]
    ) -> None:
        content = json.dumps(body).encode()
        head = (
            f"HTTP/1.1 {status} {_REASONS[status]}\r\n"
            f"Content-Type: application/json\r\nContent-Length: {len(content)}\r\n"
            "Cache-Control: no-store\r\nConnection: close\r\n\r\n"
        )
        # It fits into the socket's buffer: nothing here waits for a client.
        connection.peer.send(head.encode() + content)
        self._drop(connection)


class _Request:
    """A request that has come as a whole."""

    def __init__(self, line: str, token: bytes, body: bytes) -> None:
        self.line = line
        self.token = token
        self._body = body

    @classmethod
    def parse(cls, received: bytes) -> "_Request | None":
        """Return the request, or None while a part of it is missing."""
        head, separator, body = received.partition(b"\r\n\r\n")
        if not separator:
            return None
        first, *lines = head.split(b"\r\n")
        headers = {
            name.strip().lower(): value.strip()
            for name, _, value in (line.partition(b":") for line in lines)
        }
        length = headers.get(b"content-length", b"0")
        if length.isdigit() and len(length) < 6 and len(body) < int(length):
            return None
        words = first.decode("latin-1").split(" ")
        path = words[1].partition("?")[0] if len(words) > 1 else ""
        scheme, _, token = headers.get(b"authorization", b"").partition(b" ")
        is_bearer = scheme.lower() == b"bearer"
        return cls(f"{words[0]} {path}", token.strip() if is_bearer else b"", body)

    def reason(self) -> str | None:
        """Return the reason in the body of a stop; None when there is none."""
        try:
            fields = json.loads(self._body)
        except ValueError:
            return None  # a body that cannot be read is never in a stop's way
        reason = fields.get("reason") if isinstance(fields, dict) else None
        return reason if isinstance(reason, str) and reason else None


def _problem(code: str, detail: str) -> dict[str, object]:
    return {"code": code, "detail": detail}


def _stopped(detail: str, *, done: bool) -> dict[str, object]:
    return {"state": "stopped", "carried_out": done, "detail": detail}
