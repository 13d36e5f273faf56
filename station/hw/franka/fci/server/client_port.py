"""One TCP port that serves one client at a time, with the client's UDP datagrams.

The port listens all the time: a client can connect as soon as the one before has closed
its connection. A second client is hung up on: libfranka would wait for ever.
"""

import contextlib
import logging
import select
import socket
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from station.core.errors import StationError
from station.hw.franka.fci.wire.messages import FciProtocolError

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

_logger = logging.getLogger(__name__)
_CHUNK = 65_536


class FciPortError(StationError, OSError):
    """The server cannot listen at an address."""

    code = "fci_port"


class ClientSession(Protocol):
    """The interface of a client's session to its port."""

    udp_port: int | None

    def receive(self, data: bytes) -> bytes:
        """Take bytes of the TCP stream; return answers."""

    def close(self) -> None:
        """End the motion that the client has begun."""


_Session = TypeVar("_Session", bound=ClientSession)


class ClientPort(Generic[_Session]):
    """Listens, accepts one client, and moves bytes between it and its session.

    Args:
        what: Name of the server, for messages.
        address: Host and TCP port.
        make_session: Makes the session of a new client.

    Attributes:
        session: The session of the client; None without a client.

    Raises:
        FciPortError: The address cannot be used.
    """

    def __init__(
        self, what: str, address: tuple[str, int], make_session: Callable[[], _Session]
    ) -> None:
        self._what = what
        self._address = address
        self._make_session = make_session
        self._connection: socket.socket | None = None
        self._peer = ""
        self._unsent = bytearray()
        self.session: _Session | None = None
        self._listener: socket.socket | None = self._listen()
        self._udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._udp.bind((address[0], 0))
        self._udp.settimeout(0.0)

    def readers(self) -> list[socket.socket]:
        """Return the sockets from which something may arrive."""
        own = [] if self._connection is None else [self._connection, self._udp]
        return own if self._listener is None else [self._listener, *own]

    def writers(self) -> list[socket.socket]:
        """Return the sockets that still have something to send."""
        return [self._connection] if self._connection and self._unsent else []

    def handle(self) -> None:
        """Read TCP, send waiting bytes, and accept a new client."""
        if self._connection is not None and self.session is not None:
            self._receive(self._connection, self.session)
            self.send(b"")
        if self._listener is not None:
            self._accept(self._listener)

    def datagrams(self) -> list[bytes]:
        """Return the datagrams that the client has sent since the last call."""
        found: list[bytes] = []
        # libfranka sends its commands from the socket at which it receives the states.
        # Datagrams from another port or address come from another program.
        own = self._peer, None if self.session is None else self.session.udp_port
        while self._connection is not None:
            try:
                data, address = self._udp.recvfrom(_CHUNK)
            except (BlockingIOError, ConnectionRefusedError):
                break
            if address == own:
                found.append(data)
        return found

    def send(self, data: bytes) -> None:
        """Send answers over TCP; the part that does not fit waits for the next call."""
        if self._connection is None or not (self._unsent or data):
            return
        self._unsent += data
        try:
            sent = self._connection.send(self._unsent)
        except BlockingIOError:
            return
        except OSError as error:
            self._drop(f"the connection broke: {error.strerror}")
            return
        del self._unsent[:sent]

    def send_datagram(self, data: bytes | bytearray) -> None:
        """Send a state to the client; a client that does not listen loses it."""
        if self.session is not None and self.session.udp_port is not None:
            # Any error: the client may have named a port that cannot exist.
            with contextlib.suppress(OSError):
                self._udp.sendto(data, (self._peer, self.session.udp_port))

    def set_open(self, *, is_open: bool) -> None:
        """Listen, or send the client away and refuse connections."""
        if not is_open and self._connection is not None:
            self._drop("the port was closed")
        if not is_open and self._listener is not None:
            self._listener.close()
            self._listener = None
        elif is_open and self._listener is None:
            self._listener = self._listen()

    def close(self) -> None:
        """Send the client away and listen no longer."""
        self.set_open(is_open=False)
        self._udp.close()

    def _listen(self) -> socket.socket:
        host, port = self._address
        try:
            listener = socket.create_server(self._address, backlog=1)
        except OSError as error:
            raise FciPortError(
                f"{self._what} cannot be served at {host}:{port}: {error.strerror}.",
                remedy="End what listens there, or choose another --host: libfranka "
                "has fixed ports, and 127.0.0.2 is as good a loopback as 127.0.0.1.",
            ) from error
        listener.settimeout(0.0)
        return listener

    def _accept(self, listener: socket.socket) -> None:
        try:
            connection, address = listener.accept()
        except BlockingIOError:
            return
        if self._connection is not None:
            connection.close()
            _logger.info("%s: %s:%d must wait its turn", self._what, *address[:2])
            return
        self._connection = connection
        self._connection.settimeout(0.0)
        self._connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._peer = address[0]
        _logger.info("%s: %s:%d has connected", self._what, *address[:2])
        try:
            self.session = self._make_session()
        except FciProtocolError as error:
            self._turn_away(error)

    def _receive(self, connection: socket.socket, session: _Session) -> None:
        try:
            data = connection.recv(_CHUNK)
        except BlockingIOError:
            return
        except OSError as error:
            self._drop(f"the connection broke: {error.strerror}")
            return
        if not data:
            self._drop("the client has gone")
            return
        try:
            self.send(session.receive(data))
        except FciProtocolError as error:
            self._turn_away(error)

    def _turn_away(self, error: FciProtocolError) -> None:
        """Send the last answer to the client, and end the connection."""
        _logger.warning("%s: %s", self._what, error.message)
        self.send(error.answers)
        self._hang_up()

    def _drop(self, reason: str) -> None:
        _logger.info("%s: %s", self._what, reason)
        self._hang_up()

    def _hang_up(self) -> None:
        if self.session is not None:
            self.session.close()
        if self._connection is not None:
            self._connection.close()
        self.session, self._connection = None, None
        self._unsent.clear()


def serve(
    ports: Sequence[ClientPort[Any]], longest: float, *others: "Connection[Any, Any]"
) -> bool:
    """Wait until bytes arrive at ports or can be sent there, and move them.

    Args:
        ports: The ports.
        longest: Longest wait [s].
        others: Pipes to wait for, too.

    Returns:
        Whether something has arrived at the pipes; the ports were left alone.
    """
    readers: list[Any] = [*others, *(one for port in ports for one in port.readers())]
    writers = [one for port in ports for one in port.writers()]
    ready, sendable, _ = select.select(readers, writers, [], longest)
    found = {*ready, *sendable}
    if found.intersection(others):
        return True
    for port in ports:
        if found.intersection(port.readers()):
            port.handle()
    return False
