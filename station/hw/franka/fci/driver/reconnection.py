"""Connect again to an arm that was lost, in a thread of its own.

A connection takes up to some seconds to fail. The control thread asks for one and finds
it here; it never waits.
"""

import contextlib
import socket
import struct
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from station.core.errors import StationError
from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.fci.driver.fci_client import FciClient, robot_client
from station.hw.franka.fci.driver.network import (
    SLICE,
    UDP_TIMEOUT,
    FciNetworkError,
    Network,
)
from station.hw.franka.fci.driver.refusals import refusal_of
from station.hw.franka.fci.wire.robot_protocol import Command, RobotProtocol

_ID = struct.Struct("<Q")


@dataclass(frozen=True, slots=True)
class Connection:
    """A connection to an arm that has sent its first state.

    Attributes:
        network: The network.
        client: Asks the arm.
        message_id: Number of the state.
    """

    network: Network
    client: FciClient[Command]
    message_id: int


class Reconnection:
    """Opens new connections when the control thread asks for one.

    Args:
        open_network: Opens a connection.
        protocol: The version that is spoken.
    """

    def __init__(
        self, open_network: Callable[[], Network], protocol: RobotProtocol
    ) -> None:
        self._open_network, self._protocol = open_network, protocol
        self._settings: list[tuple[Command, Mapping[str, Any]]] = []
        self._found: Connection | str | None = None
        self._word, self._ear = socket.socketpair()
        self._word.settimeout(0.0)
        self._thread = threading.Thread(target=self._run, name="connect", daemon=True)
        self._thread.start()

    def ask(self, settings: list[tuple[Command, Mapping[str, Any]]]) -> None:
        """Ask for a connection, once at a time.

        Args:
            settings: Requests that follow the connection.
        """
        self._found, self._settings = None, settings
        # A full socket has a word in it already.
        with contextlib.suppress(BlockingIOError):
            self._word.send(b"\0")

    def take_connection(self) -> Connection | str | None:
        """Return the new connection once, or the reason for its failure, else None."""
        found, self._found = self._found, None
        return found

    def close(self) -> None:
        """End the thread, and hang up what nobody has taken."""
        self._word.close()
        self._thread.join()
        self._ear.close()
        if isinstance(self._found, Connection):
            self._found.network.close()

    def _run(self) -> None:
        while self._ear.recv(1):
            try:
                self._found = self._connect()
            except StationError as error:
                self._found = error.message

    def _connect(self) -> Connection:
        """Connect, and wait for the first state.

        Raises:
            StationError: The arm does not answer (`FciNetworkError`), or speaks another
                version (`FciProtocolError`).
            FciNetworkError: The arm refuses a setting.
        """
        network = self._open_network()
        try:
            client = robot_client(network, self._protocol)
            client.connect()
            number = self._first_state(network)
            for command, values in self._settings:
                answer = client.ask(command, values)
                if answer.status:  # 0 is success for every command
                    mode = RobotMode.OTHER
                    raise FciNetworkError(refusal_of(command, answer.status, mode))
        except StationError:
            network.close()
            raise
        return Connection(network, client, number)

    def _first_state(self, network: Network) -> int:
        """Return the number of the first state.

        Raises:
            FciNetworkError: None has come.
        """
        size = self._protocol.state.size
        buffer = bytearray(size + 1)
        for _ in range(round(UDP_TIMEOUT / SLICE)):
            if network.wait(buffer) == size:
                number: int = _ID.unpack_from(buffer, 0)[0]
                return number
        raise FciNetworkError("libfranka: UDP receive: Timeout")
