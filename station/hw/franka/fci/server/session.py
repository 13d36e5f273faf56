"""One client of an arm or a hand: it connects, and then its requests are answered."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Generic

from station.hw.franka.fci.wire.messages import (
    FciProtocolError,
    Messages,
    Request,
)
from station.hw.franka.fci.wire.robot_protocol import (
    CommandT,
    FciProtocol,
    Status,
)


class ClientSession(ABC, Generic[CommandT]):
    """Serves one client; each client gets a new session. Control thread.

    Args:
        protocols: The versions that are spoken; the client chooses one. The last one
            is the device's own: a client that asks for another version gets it as the
            answer.

    Attributes:
        udp_port: The client's UDP port; None until it has connected.
    """

    def __init__(self, protocols: Sequence[FciProtocol[CommandT]]) -> None:
        self._protocols = protocols
        self._speak(protocols[-1])  # a client connects in the same way with all
        self.udp_port: int | None = None

    def receive(self, data: bytes) -> bytes:
        """Take bytes of the TCP stream; return the answers that are due at once.

        Args:
            data: The next bytes.

        Raises:
            FciProtocolError: The client broke the protocol; the connection must end.
        """
        requests = self._messages.requests(data)
        return b"".join(self._answer(request) for request in requests)

    @abstractmethod
    def _serve(self, request: Request[CommandT]) -> bytes:
        """Carry a request of a connected client out; return the answers that are due.

        Args:
            request: The request.
        """

    def _speak(self, protocol: FciProtocol[CommandT]) -> None:
        self._protocol, self._messages = protocol, Messages(protocol)
        self._say = self._messages.answer

    def _answer(self, request: Request[CommandT]) -> bytes:
        device, command = self._protocol.device, request.command
        if command is self._protocol.connect:
            return self._connect(request)
        if self.udp_port is None:
            raise FciProtocolError(
                f"The client sent {command.name} before it had connected.",
                remedy=f"Connect first, with a version that the {device} speaks.",
            )
        return self._serve(request)

    def _connect(self, request: Request[CommandT]) -> bytes:
        if self.udp_port is not None:
            raise FciProtocolError(
                "The client connected a second time.", remedy="Connect once."
            )
        asked = request.values["version"]
        for protocol in self._protocols:
            if asked == protocol.version:
                self._speak(protocol)
                self.udp_port = request.values["udp_port"]
                return self._say(request, Status.SUCCESS, {"version": asked})
        own = self._protocol
        status = Status.INCOMPATIBLE_LIBRARY_VERSION
        told = self._say(request, status, {"version": own.version})
        *others, last = sorted(protocol.version for protocol in self._protocols)
        spoken = f"{', '.join(map(str, others))} and {last}" if others else last
        raise FciProtocolError(
            f"The client asked for version {asked} of the {own.device}'s protocol; "
            f"spoken is {spoken}.",
            remedy="Use a libfranka that speaks this version.",
            answers=told,
        )
