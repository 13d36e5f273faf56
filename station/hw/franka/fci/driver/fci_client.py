"""Requests to an arm or a hand and its answers, over the TCP connection.

Source: libfranka@0.9.2 src/network.h, connect; src/robot_impl.h, executeCommand.
"""

from collections.abc import Mapping
from typing import Any, Generic, TypeAlias

from station.hw.franka.fci.driver.network import (
    TCP_TIMEOUT,
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
    ConnectStatus,
    FciProtocol,
    RobotProtocol,
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
        if answer.status == ConnectStatus.INCOMPATIBLE_LIBRARY_VERSION:
            raise IncompatibleVersionError(own, answer.values["version"])
        if answer.status != ConnectStatus.SUCCESS:
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


def robot_client(network: FciNetwork, protocol: RobotProtocol) -> FciClient[Command]:
    """Return a client of an arm."""
    return FciClient(network, protocol)
