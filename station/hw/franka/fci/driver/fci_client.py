"""Requests to an arm or a hand and its answers, over the TCP connection.

Source: libfranka@0.9.2 src/network.h, connect; src/robot_impl.h, executeCommand.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeAlias

from station.core.errors import StationError
from station.hw.franka.fci.driver.network import (
    SLICE,
    TCP_TIMEOUT,
    UDP_TIMEOUT,
    FciNetwork,
    FciNetworkError,
)
from station.hw.franka.fci.wire.messages import (
    NOTHING,
    Answer,
    FciProtocolError,
    Messages,
)
from station.hw.franka.fci.wire.robot_protocol import (
    Command,
    CommandT,
    FciProtocol,
    Status,
)

RobotAnswer: TypeAlias = Answer[Command]


class IncompatibleVersionError(FciProtocolError):
    """The other side speaks another version of the protocol.

    Args:
        own: The version of this side.
        server_version: The version of the other side.
    """

    code = "fci_version"

    def __init__(self, own: int, server_version: int) -> None:
        super().__init__(
            "libfranka: Incompatible library version (server version: "
            f"{server_version}, library version: {own}).",
            remedy="Set robot.arm to the kind of the arm at robot.robot_ip: panda for "
            "a system with libfranka 0.9, fr3 for a newer one.",
        )
        self.server_version = server_version


class FciClient(Generic[CommandT]):
    """Sends requests to an arm or a hand, and keeps their answers. One thread.

    Args:
        network: The network.
        protocol: The version that is spoken.
    """

    def __init__(self, network: FciNetwork, protocol: FciProtocol[CommandT]) -> None:
        self._network, self._protocol = network, protocol
        self._messages = Messages(protocol)
        self._count = 0
        self._forgotten = 0
        self._answers: dict[int, list[Answer[CommandT]]] = {}

    def connect(self) -> None:
        """Send the version of this side and the port that receives states.

        Raises:
            FciNetworkError: No answer came.
            IncompatibleVersionError: The other side speaks another version.
            FciProtocolError: The answer is malformed.
        """
        own, port = self._protocol.version, self._network.udp_port
        asked = {"version": own, "udp_port": port}
        answer = self.ask(self._protocol.connect, asked)
        if answer.status is Status.INCOMPATIBLE_LIBRARY_VERSION:
            raise IncompatibleVersionError(own, answer.values["version"])
        if answer.status is not Status.SUCCESS:
            raise FciProtocolError(
                "libfranka: Protocol error during connection attempt"
            )

    def send(self, command: CommandT, values: Mapping[str, Any] = NOTHING) -> int:
        """Send a request; return its number.

        Raises:
            FciNetworkError: The connection is broken.
        """
        self._count += 1
        self._network.send(self._messages.request(command, self._count, values))
        return self._count

    def ask(
        self, command: CommandT, values: Mapping[str, Any] = NOTHING
    ) -> Answer[CommandT]:
        """Send a request and wait for its first answer.

        Raises:
            FciNetworkError: The connection is broken, or no answer came in time.
            FciProtocolError: The message is not an answer.
        """
        number = self.send(command, values)
        answer = self.take_answer(number) or self.take_answer(number, TCP_TIMEOUT)
        if answer is None:
            raise FciNetworkError(
                f"libfranka: TCP receive: no answer to {command.name} within "
                f"{TCP_TIMEOUT:g} s",
                remedy="Check the arm and the network, then connect again.",
            )
        return answer

    def take_answer(self, number: int, timeout: float = 0.0) -> Answer[CommandT] | None:
        """Return the next answer to a request; None if there is none.

        Args:
            number: Number of the request.
            timeout: How long to wait for something to arrive [s].

        Raises:
            FciNetworkError: The connection is broken.
            FciProtocolError: The message is not an answer.
        """
        while not (found := self._answers.get(number)):
            data = self._network.receive(timeout)
            if not data:
                return None
            for answer in self._messages.answers(data):
                if answer.command_id == self._forgotten:
                    continue
                self._answers.setdefault(answer.command_id, []).append(answer)
        answer = found.pop(0)
        if not found:
            del self._answers[number]
        return answer

    def forget(self, number: int) -> None:
        """Drop the answers to a request, also those that are still to come."""
        self._answers.pop(number, None)
        self._forgotten = number


@dataclass(frozen=True, slots=True)
class Connection(Generic[CommandT]):
    """A connection to an arm or a hand that has sent its first state.

    Attributes:
        network: The network.
        client: Asks the arm or the hand.
        state: The first state.
    """

    network: FciNetwork
    client: FciClient[CommandT]
    state: bytes


def connect(
    network: FciNetwork, protocol: FciProtocol[CommandT]
) -> Connection[CommandT]:
    """Send this side's version, and wait for the first state.

    Args:
        network: The network; it is closed if there is an error.
        protocol: The version that is spoken.

    Raises:
        StationError: The other side does not answer (`FciNetworkError`), or does not
            speak this version (`FciProtocolError`).
    """
    try:
        client = FciClient(network, protocol)
        client.connect()
        return Connection(network, client, _first_state(network, protocol.state.size))
    except StationError:
        network.close()
        raise


def _first_state(network: FciNetwork, size: int) -> bytes:
    """Return the first state.

    Raises:
        FciNetworkError: No state has come.
    """
    buffer = bytearray(size + 1)  # shows a datagram that is too long
    for _ in range(round(UDP_TIMEOUT / SLICE)):
        if network.wait(buffer) == size:
            return bytes(buffer[:size])
    raise FciNetworkError(
        "libfranka: UDP receive: Timeout",
        remedy="Let UDP datagrams of the arm through the firewall.",
    )
