"""The watchdog's HTTP server, for readiness, the stop and incidents.

It uses `http.server` of the standard library. Each client has a thread, so that a
silent client delays neither the watchdog nor other clients.
"""

import hashlib
import json
import socket
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from hmac import compare_digest
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

from station.app.watchdog.watch import Watch, WatchdogSettings

CONNECTIONS = 16
"""Most connections at a time; a new one, which may be a stop, closes the oldest."""
_REQUEST_TIME = 1.0
_MAX_BODY = 8192
_CONFIRM_TIME = 0.05
"""Longest wait of the answer to a stop for the loop to carry it out [s]."""

Answer = tuple[int, dict[str, object]]
"""HTTP status and body of an answer."""


class WatchdogServer(ThreadingHTTPServer):
    """Serves `GET /ready`, `GET /incident` and `POST /stop` on a loopback socket.

    `handle_request` accepts a waiting connection, and returns at once.

    Args:
        listener: Listening socket at a loopback address.
        settings: Settings with the station's tokens that are accepted, besides named
            tokens.
        watch: Knows the state of the station, and makes the arms hold on a stop.
        clock: Returns the monotonic time for `watch` [s].
        request_time: Longest silence of a client [s], > 0.

    Attributes:
        lock: Lock to hold while using `watch`.
    """

    timeout = 0.0
    daemon_threads = True

    def __init__(
        self,
        listener: socket.socket,
        settings: WatchdogSettings,
        watch: Watch,
        clock: Callable[[], float] = time.monotonic,
        request_time: float = _REQUEST_TIME,
    ) -> None:
        super().__init__(listener.getsockname(), _Client, bind_and_activate=False)
        self.socket.close()
        self.socket = listener
        # Accepting must not wait for a client that has already given up.
        self.socket.settimeout(0.0)
        self.lock = threading.Lock()
        self.watch = watch
        self.clock = clock
        self.request_time = request_time
        self._roles = {
            settings.operator_token: "operator",
            settings.viewer_token: "viewer",
        }
        self._named: dict[str, tuple[str, float | None]] = {}
        self._open: list[socket.socket] = []
        self._open_lock = threading.Lock()

    def take_token(self, digest: str, role: str, expires: float | None) -> None:
        """Accept a named token of the station from now on, or forget it.

        Args:
            digest: SHA-256 of the token, hexadecimal.
            role: Role of the token; empty for a token that has ended.
            expires: Wall time when it expires [s since 1970]; None if it does not
                expire.
        """
        if role:
            self._named[digest] = (role, expires)
        else:
            self._named.pop(digest, None)

    def role(self, token: bytes) -> str | None:
        """Return the role of a token; None if the token is unknown."""
        found = None
        for known, role in self._roles.items():
            # Compare in constant time, so that the time tells nothing about a token.
            if compare_digest(known.encode(), token):
                found = found or role
        if found is not None:
            return found
        # The time to look up the hash of a secret tells nothing about the secret.
        named = self._named.get(hashlib.sha256(token).hexdigest())
        if named is None or (named[1] is not None and time.time() >= named[1]):
            return None
        return named[0]

    def ready(self) -> Answer:
        """Answer whether the station is ready, or the reason why it is not."""
        with self.lock:
            now = self.clock()
            trouble = self.watch.trouble(now)
            if trouble is not None:
                return 503, _problem("not_ready", trouble)
            return 200, {"ready": True, "last_wake_up_age": self.watch.age(now)}

    def incident(self) -> Answer:
        """Answer with the last standstill of the loop."""
        with self.lock:
            incident = self.watch.incident
            if incident is None:
                detail = "The loop has not stood still so far."
                return 404, _problem("no_incident", detail)
            return 200, dict(incident.facts)

    def stop(self, reason: str) -> Answer:
        """Latch a stop; answer whether the loop has carried it out in time."""
        heartbeat = self.watch.heartbeat
        with self.lock:
            heartbeat.ask_stop(reason)
            now = self.clock()
            if self.watch.trouble(now) is not None:
                self.watch.hold(now)
        deadline = time.monotonic() + _CONFIRM_TIME
        while heartbeat.is_stop_asked and time.monotonic() < deadline:
            time.sleep(0.001)
        if not heartbeat.is_stop_asked:
            return 200, _stopped("The loop has carried it out.", done=True)
        with self.lock:
            now = self.clock()
            self.watch.hold(now)
            trouble = self.watch.trouble(now) or "The loop has not answered yet."
        detail = (
            f"{trouble} The stop is latched: a loop that comes back carries it out "
            "before it writes anything to the robot."
        )
        return 200, _stopped(detail, done=False)

    def enter(self, client: socket.socket) -> None:
        """Note a client; close the oldest one if there are too many."""
        with self._open_lock:
            if len(self._open) >= CONNECTIONS:
                # Its thread wakes up and closes the socket. The client may have left
                # already.
                with suppress(OSError):
                    self._open.pop(0).shutdown(socket.SHUT_RDWR)
            self._open.append(client)

    def leave(self, client: socket.socket) -> None:
        """Forget a client."""
        with self._open_lock, suppress(ValueError):
            self._open.remove(client)

    def handle_error(self, request: object, client_address: object) -> None:
        """Print the error of a thread, unless a client has left."""
        # A client that has left is no error. The reader of stderr may also be gone.
        if not isinstance(sys.exception(), OSError):
            with suppress(OSError):
                super().handle_error(request, client_address)  # type: ignore[arg-type] # passed on


class _Client(BaseHTTPRequestHandler):
    """A client, which may send one request."""

    server: WatchdogServer
    protocol_version = default_request_version = "HTTP/1.1"
    wbufsize = -1  # send head and body in one packet
    error_content_type = "application/json"
    error_message_format = '{"code": "bad_request", "detail": "Status %(code)d."}'

    def setup(self) -> None:
        """Note the client, and limit the time in which it must send its request."""
        super().setup()
        self.connection.settimeout(self.server.request_time)
        self.server.enter(self.connection)

    def finish(self) -> None:
        """Close the connection, and forget the client."""
        self.server.leave(self.connection)
        super().finish()

    def do_GET(self) -> None:
        """Answer a GET or POST request."""
        path = self.path.partition("?")[0]
        role = self.server.role(self._token())
        if (self.command, path) == ("GET", "/ready"):
            self._answer(self.server.ready())
        elif role is None:
            detail = "A token of the station is needed: Authorization: Bearer …"
            self._answer((401, _problem("unauthorized", detail)))
        elif (self.command, path) == ("GET", "/incident"):
            self._answer(self.server.incident())
        elif (self.command, path) == ("POST", "/stop"):
            reason = self._reason() or "no reason given"
            self._answer(
                self.server.stop(f"{reason} (the {role}, through the watchdog)")
            )
        else:
            detail = "There are GET /ready, GET /incident and POST /stop."
            self._answer((404, _problem("not_found", detail)))

    do_POST = do_GET  # noqa: N815 - the name that `http.server` calls

    def _token(self) -> bytes:
        scheme, _, token = self.headers.get("Authorization", "").partition(" ")
        return token.strip().encode("latin-1") if scheme.lower() == "bearer" else b""

    def _reason(self) -> str | None:
        """Return the reason in the body of a stop; None without a reason."""
        try:
            length = min(int(self.headers.get("Content-Length", "0")), _MAX_BODY)
            fields = json.loads(self.rfile.read(max(length, 0)))
        except (ValueError, OSError):
            return None  # an unreadable body must not prevent a stop
        reason = fields.get("reason") if isinstance(fields, dict) else None
        return reason if isinstance(reason, str) and reason else None

    def _answer(self, answer: Answer) -> None:
        status, body = answer
        content = json.dumps(body).encode()
        self.send_response_only(status)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("Connection", "close")
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - its name
        """Log nothing: stderr is for the watchdog's messages to users."""


def _problem(code: str, detail: str) -> dict[str, object]:
    return {"code": code, "detail": detail}


def _stopped(detail: str, *, done: bool) -> dict[str, object]:
    return {"state": "stopped", "carried_out": done, "detail": detail}
