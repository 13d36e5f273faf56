"""Start Viser so that only the gateway can talk to it.

Viser has no login. It listens on a loopback port and refuses connections without the
gateway's secret, because other users of the same machine reach loopback too. The check
hooks into the `serve` that Viser calls, which is private. So `viser` is pinned, and
`tests/ui/gateway/test_viser_server.py` fails when the hook no longer works.
"""

import contextlib
import hmac
import io
import secrets
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from http import HTTPStatus
from typing import Any

import viser
import websockets.asyncio.server
from viser import _messages as viser_messages  # noqa: PLC2701 - no public name
from websockets.asyncio.server import (
    ServerConnection,
    serve as Serve,  # noqa: N812 - it is a class
)
from websockets.http11 import Request, Response

SECRET_HEADER = "X-Station-Gateway"
SESSION_HEADER = "X-Station-Session"
"""Carries the key of the session whose browser opens a connection."""

_ProcessRequest = Callable[[ServerConnection, Request], Response | None]


@dataclass(frozen=True, slots=True)
class GuardedViser:
    """A Viser server that only the gateway can reach.

    Attributes:
        server: The Viser server, listening on 127.0.0.1.
        port: The port it listens on.
        secret: The value of `SECRET_HEADER` that opens it.
    """

    server: viser.ViserServer
    port: int
    secret: str

    def session_key(self, client: viser.ClientHandle) -> str:
        """Return the key of the session of a browser; empty when it is unknown."""
        # Viser tells no request headers, but it keeps the connections that have them.
        live = self.server._websock_server._live_connections  # noqa: SLF001
        connection = live.get(client.client_id)
        if connection is None or connection.request is None:
            return ""
        return connection.request.headers.get(SESSION_HEADER, "")

    def stop(self) -> None:
        """Stop the server and its threads."""
        with _quiet():
            self.server.stop()


def open_viser(label: str) -> GuardedViser:
    """Start a Viser server on a free loopback port that asks for a secret.

    Args:
        label: Title of its control panel.

    Returns:
        The running server and the secret that opens it.
    """
    secret = secrets.token_urlsafe(32)
    with _quiet(), _secret_before_serve(secret):
        server = viser.ViserServer(host="127.0.0.1", port=0, label=label, verbose=False)
    connection = server._websock_server  # noqa: SLF001 - Viser has no public way
    connection.unregister_handler(viser_messages.ShareUrlRequest)
    connection.unregister_handler(viser_messages.ShareUrlDisconnect)
    return GuardedViser(server, server.get_port(), secret)


@contextlib.contextmanager
def _secret_before_serve(secret: str) -> Iterator[None]:
    """Let every WebSocket server that starts inside this block ask for the secret."""
    serve = Serve
    expected = secret.encode()

    def guarded_serve(
        *args: Any,  # noqa: ANN401 - whatever Viser passes
        process_request: _ProcessRequest | None = None,
        **kwargs: Any,  # noqa: ANN401 - whatever Viser passes
    ) -> Serve:
        return serve(
            *args, process_request=_secret_check(expected, process_request), **kwargs
        )

    websockets.asyncio.server.serve = guarded_serve  # type: ignore[misc, assignment]  # the hook
    try:
        yield
    finally:
        websockets.asyncio.server.serve = serve  # type: ignore[misc]  # as it was


def _secret_check(
    expected: bytes,
    inner: _ProcessRequest | None,
) -> _ProcessRequest:
    def process_request(
        connection: ServerConnection, request: Request
    ) -> Response | None:
        brought = request.headers.get_all(SECRET_HEADER)
        value = brought[0].encode() if len(brought) == 1 else b""
        if not hmac.compare_digest(value, expected):
            return connection.respond(
                HTTPStatus.FORBIDDEN, "Open the dashboard at its own address.\n"
            )
        return None if inner is None else inner(connection, request)

    return process_request


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Keep Viser from printing an address that must not be opened."""
    with contextlib.redirect_stdout(io.StringIO()):
        yield
