"""Convert requests and answers to bytes, and read them from a stream of bytes."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Generic

from station.core.errors import StationError
from station.hw.franka.fci.wire.robot_protocol import CommandT, FciProtocol, Status

NOTHING: Mapping[str, Any] = MappingProxyType({})
"""The fields of a message without fields."""


class FciProtocolError(StationError):
    """The other side broke the protocol; the connection ends.

    Args:
        message: The message that came, and the allowed ones.
        remedy: Advice.
        answers: Answers to send before the connection ends.
    """

    code = "fci_protocol"

    def __init__(self, message: str, *, remedy: str = "", answers: bytes = b"") -> None:
        super().__init__(message, remedy=remedy)
        self.answers = answers


@dataclass(frozen=True, slots=True)
class Answer(Generic[CommandT]):
    """One answer of a robot or a hand.

    Attributes:
        command: The answered command.
        command_id: Number of the request.
        status: The status; `Status.UNKNOWN` if the version that is spoken does not have
            its number.
        values: All fields, the status as its number on the wire.
        rest: Bytes behind the fields, e.g. a model library.
    """

    command: CommandT
    command_id: int
    status: Status
    values: Mapping[str, Any]
    rest: bytes = b""

    @property
    def words(self) -> str:
        """The status in words, e.g. `reflex aborted`."""
        return self.status.name.lower().replace("_", " ")


@dataclass(frozen=True, slots=True)
class Request(Generic[CommandT]):
    """One request of a client.

    Attributes:
        command: The requested command.
        command_id: Number of the request, which its answers repeat.
        values: The fields of the request.
    """

    command: CommandT
    command_id: int
    values: Mapping[str, Any]


class Messages(Generic[CommandT]):
    """Makes the messages of a version, and reads those of one TCP stream.

    A client makes requests and reads answers, a server the other way round.

    Args:
        protocol: The version.
    """

    def __init__(self, protocol: FciProtocol[CommandT]) -> None:
        self._header, self._exchanges = protocol.header, protocol.exchanges
        self._commands = {one.number: key for key, one in self._exchanges.items()}
        self._received = bytearray()

    def request(
        self, command: CommandT, number: int, values: Mapping[str, Any] = NOTHING
    ) -> bytes:
        """Return a request as bytes.

        Args:
            command: The requested command.
            number: Number of the request, which its answers repeat.
            values: The fields of the request.
        """
        return self._pack(
            command, number, self._exchanges[command].request.pack(values)
        )

    def answer(
        self,
        request: Request[CommandT],
        status: Status,
        values: Mapping[str, Any] = NOTHING,
        *,
        tail: bytes = b"",
    ) -> bytes:
        """Return an answer as bytes.

        Args:
            request: The request.
            status: The status, one of those that the version has for the command.
            values: The fields of the answer behind the status.
            tail: Bytes after the fields, e.g. a model.
        """
        exchange = self._exchanges[request.command]
        number = exchange.statuses.index(status)
        body = exchange.response.pack({"status": number, **values}) + tail
        return self._pack(request.command, request.command_id, body)

    def requests(self, data: bytes) -> Iterator[Request[CommandT]]:
        """Return the requests that are complete now; the rest waits for more bytes.

        Args:
            data: The next bytes of the stream.

        Raises:
            FciProtocolError: A command is unknown, or its size is another one than the
                protocol has.
        """
        for command, number, body in self._cut(data, self._check_request):
            values = self._exchanges[command].request.unpack(body)
            yield Request(command, number, values)

    def answers(self, data: bytes) -> Iterator[Answer[CommandT]]:
        """Return the answers that are complete now; the rest waits for more bytes.

        Args:
            data: The next bytes of the stream.

        Raises:
            FciProtocolError: A message in the stream is not an answer of the protocol.
        """
        for command, number, body in self._cut(data, self._check_answer):
            exchange = self._exchanges[command]
            size = exchange.response.size
            values = exchange.response.unpack(body[:size])
            status = exchange.status_of(values["status"])
            yield Answer(command, number, status, values, body[size:])

    def _cut(
        self, data: bytes, check: Callable[[int, int], CommandT]
    ) -> Iterator[tuple[CommandT, int, bytes]]:
        """Return command, number and body of each message, however TCP has cut them.

        Args:
            data: The next bytes of the stream.
            check: Returns the command, given its number and the size of the message;
                refuses a message that the protocol does not have.
        """
        self._received += data
        start = self._header.size
        while len(self._received) >= start:
            head = self._header.unpack(self._received[:start])
            # Checked before the body has come: the size in a foreign head means
            # nothing.
            command, size = check(head["command"], head["size"]), head["size"]
            if len(self._received) < size:
                return
            body = bytes(self._received[start:size])
            del self._received[:size]
            yield command, head["command_id"], body

    def _check_request(self, number: int, size: int) -> CommandT:
        command = self._commands.get(number)
        if command is None:
            raise FciProtocolError(
                f"The client sent the command {number}, which the protocol does not "
                "have.",
                remedy="Use a client of the version that it has connected with.",
            )
        expected = self._header.size + self._exchanges[command].request.size
        if size != expected:
            raise FciProtocolError(
                f"The client sent {command.name} with a size of {size} bytes; the "
                f"protocol has {expected}.",
                remedy="Use a client of the version that it has connected with.",
            )
        return command

    def _check_answer(self, number: int, size: int) -> CommandT:
        command = self._commands.get(number)
        if command is None:
            raise FciProtocolError(f"libfranka: Unexpected answer to command {number}.")
        if size < self._header.size + self._exchanges[command].response.size:
            raise FciProtocolError("libfranka: Incorrect TCP message size.")
        return command

    def _pack(self, command: CommandT, number: int, body: bytes) -> bytes:
        """Return a message with its head."""
        head = {
            "command": self._exchanges[command].number,
            "command_id": number,
            "size": self._header.size + len(body),
        }
        return self._header.pack(head) + body
