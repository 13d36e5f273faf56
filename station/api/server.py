"""The web server, in a thread with an event loop of its own."""

import asyncio
import logging
import selectors
import socket
import threading
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Self

import anyio.lowlevel
import uvicorn
from fastapi import FastAPI
from typing_extensions import override
from websockets.http11 import Request

from station.api.streams.broadcaster import PORT
from station.api.tool_port import ToolPort, by_port
from station.core.errors import StationError
from station.core.loop.cycle_yield import CycleYield
from station.local.tls import TlsFiles
from station.web.limited_server import LimitedServer, SocketProtocol

if TYPE_CHECKING:
    from station.api.services import Services


SEND_BUFFER = 128 * 1024
"""Bytes that the operating system buffers for a client before it counts as slow."""


class ServerStartError(StationError, OSError):
    """The server cannot listen at its address."""

    code = "cannot_listen"


class YieldingSelector(selectors.DefaultSelector):
    """Lets a due cycle of the control loop begin before a turn of the event loop.

    Args:
        cycle_yield: Makes this thread wait when the control thread is due.
    """

    def __init__(self, cycle_yield: CycleYield) -> None:
        super().__init__()
        self._cycle_yield = cycle_yield

    @override
    def select(
        self, timeout: float | None = None
    ) -> list[tuple[selectors.SelectorKey, int]]:
        ready = super().select(timeout)
        self._cycle_yield.wait_if_cycle_is_due()
        return ready


class ApiServer:
    """Serves an application until it is stopped; installs no signal handlers.

    Args:
        app: Application, from `create_app`.
        host: Address to listen on.
        port: Port; 0 for any free one.
        tls: Certificate and key for https and wss; None for http and ws.
        ports: Tool ports to serve, with the same certificate and the same limits.

    Raises:
        TlsFilesError: The certificate or the key cannot be used.

    Attributes:
        host: The address.
        port: The port; after `start` the true one.
    """

    def __init__(
        self,
        app: FastAPI,
        host: str = "127.0.0.1",
        port: int = 8000,
        tls: TlsFiles | None = None,
        ports: Sequence[ToolPort[Any]] = (),
    ) -> None:
        self.host = host
        self.port = port
        context = None if tls is None else tls.context()
        self._scheme = "http" if context is None else "https"
        services: Services = app.state.services
        self._broadcaster = services.broadcaster
        self._cycle_yield = services.station.loop.cycle_yield
        self._ports = ports
        self._server = LimitedServer(
            uvicorn.Config(
                by_port(app, ports) if ports else app,
                ws=StreamProtocol,
                ws_max_size=64 * 1024,
                ws_ping_interval=5.0,
                ws_ping_timeout=20.0,
                ws_per_message_deflate=False,
                lifespan="off",
                log_config=None,
                log_level="warning",
                access_log=False,
                server_header=False,
                timeout_graceful_shutdown=1,
                ssl_context_factory=None if context is None else lambda *_: context,
            )
        )
        self._thread: threading.Thread | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._running = threading.Event()

    @property
    def url(self) -> str:
        """Return the URL for clients on this machine."""
        host = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(self.host, self.host)
        return f"{self._scheme}://{f'[{host}]' if ':' in host else host}:{self.port}"

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def start(self) -> int:
        """Listen and serve; return the port when connections are accepted.

        Raises:
            ServerStartError: The address is in use, or does not belong to this machine.
        """
        listeners: list[socket.socket] = []
        servers: list[ApiServer | ToolPort[Any]] = [self, *self._ports]
        try:
            for one in servers:
                listeners.append(_listen(one.host, one.port))
                one.port = listeners[-1].getsockname()[1]
        except ServerStartError:
            for listener in listeners:
                listener.close()
            raise
        self._thread = threading.Thread(
            target=self._run, args=(listeners,), name="api", daemon=True
        )
        self._thread.start()
        self._running.wait()
        return self.port

    def stop(self, timeout: float = 2.9) -> None:
        """Close all streams (1001), finish running requests, and end the thread.

        Args:
            timeout: Longest wait [s]; the thread does not keep the process alive.
        """
        thread, loop = self._thread, self._loop
        if thread is None or loop is None:
            return
        # Requests that do not end in time are cancelled on purpose, so uvicorn must not
        # log them with tracebacks as errors of the application.
        log = logging.getLogger("uvicorn.error")
        level = log.level
        log.setLevel(logging.CRITICAL)
        if thread.is_alive():
            asyncio.run_coroutine_threadsafe(self._shut_down(), loop)
        thread.join(timeout)
        log.setLevel(level)
        self._thread = None

    def _run(self, listeners: list[socket.socket]) -> None:
        with asyncio.Runner(
            loop_factory=lambda: asyncio.SelectorEventLoop(
                YieldingSelector(self._cycle_yield)
            )
        ) as runner:
            runner.run(self._serve(listeners))

    async def _serve(self, listeners: list[socket.socket]) -> None:
        self._loop = asyncio.get_running_loop()
        # anyio imports a backend at its first use. In the first request this would hold
        # the interpreter for up to 30 ms, and delay the control thread.
        await anyio.lowlevel.checkpoint()
        self._running.set()  # from now on the listeners queue connections
        try:
            await self._server.serve(sockets=listeners)
        finally:
            for connection in list(self._server.server_state.connections):
                connection.transport.abort()

    async def _shut_down(self) -> None:
        await self._broadcaster.close()
        self._server.should_exit = True


def _listen(host: str, port: int) -> socket.socket:
    """Return a socket that listens.

    Raises:
        ServerStartError: The address is in use, or does not belong to this machine.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    # asyncio turns Nagle's algorithm off only if the protocol is named. Otherwise every
    # answer would wait 40 ms for the acknowledgement of its head.
    listener = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)
    try:
        listener.bind((host, port))
        listener.listen(128)
    except OSError as error:
        listener.close()
        raise ServerStartError(
            f"Cannot listen on {host}:{port}: {error.strerror or error}.",
            remedy="Choose another port (0 means any free one) or end what has it.",
            details={"host": host, "port": port},
        ) from error
    return listener


GRACE = 2.0
"""Longest time for a client to read its close frame [s]."""


class StreamProtocol(SocketProtocol):
    """A WebSocket connection as a `StreamPort`, in the scope's state."""

    _resumed: Callable[[], None] | None = None

    @override
    def handle_connect(self, event: Request) -> None:
        super().handle_connect(event)
        if hasattr(self, "scope"):
            self.scope["state"][PORT] = self

    @override
    def resume_writing(self) -> None:
        super().resume_writing()
        if self._resumed is not None:
            self._resumed()

    def write_frame(self, wire: bytes) -> None:
        """Write a whole WebSocket frame, unless the connection is being closed.

        Args:
            wire: The frame, not masked. No extension may change it, because the server
                offers none.
        """
        if not self.close_sent and not self.transport.is_closing():
            self.transport.write(wire)

    def is_writable(self) -> bool:
        """Return whether the client keeps up with reading."""
        return self.writable.is_set()

    def listen(self, resumed: Callable[[], None] | None) -> None:
        """Call `resumed` whenever the client reads again; None ends this."""
        self._resumed = resumed

    def abort(self, code: int, reason: str) -> None:
        """Send a close frame, then cut the connection without waiting for the client.

        Args:
            code: Close code.
            reason: At most 123 bytes.
        """
        if self.close_sent or self.transport.is_closing():
            return
        self.stop_keepalive()
        self.conn.send_close(code, reason)
        self.transport.write(b"".join(self.conn.data_to_send()))
        self.close_sent = True
        if self.read_paused:
            self.read_paused = False
            self.transport.resume_reading()
        self.close_timer = self.loop.call_later(GRACE, self.transport.abort)
