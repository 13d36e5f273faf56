"""Convert requests and answers to bytes, and read them from a stream of bytes."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import IntEnum
from types import MappingProxyType
from typing import Any, Generic, TypeVar

from station.core.errors import StationError
from station.hw.franka.fci.wire.robot_protocol import Exchange
from station.hw.franka.fci.wire.structure import Structure

_Command = TypeVar("_Command", bound=IntEnum)
_Kind = TypeVar("_Kind")
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


class FciVersionError(FciProtocolError):
    """A client asked for a version that is not spoken.

    Args:
        what: Name of the server.
        asked: The version that the client asked for.
        spoken: The versions that are spoken.
        answers: The answer, which names a version that is spoken.
    """

    def __init__(
        self, what: str, asked: int, spoken: Iterable[int], answers: bytes
    ) -> None:
        *others, last = map(str, sorted(spoken))
        versions = f"{', '.join(others)} and {last}" if others else last
        super().__init__(
            f"The client asked for version {asked} of the {what}'s protocol; spoken is "
            f"{versions}.",
            remedy="Use a libfranka that speaks this version.",
            answers=answers,
        )


@dataclass(frozen=True, slots=True)
class Answer(Generic[_Command]):
    """One answer of a robot or a hand.

    Attributes:
        command: The answered command.
        command_id: Number of the request.
        status: The status, numbered alike in all versions; `UNKNOWN` if the version
            that is spoken does not have it.
        values: All fields, the status as its number on the wire.
        rest: Bytes behind the fields, e.g. a model library.
    """

    command: _Command
    command_id: int
    status: int
    values: Mapping[str, Any]
    rest: bytes = b""


class Frames(Generic[_Kind]):
    """Cuts a stream of TCP bytes into messages, however TCP has cut them.

    It also puts heads before messages.

    Args:
        header: Head of every message.
        kind_of: Returns the kind of a message, given its head; refuses the head of a
            message that the protocol does not have.
    """

    def __init__(
        self, header: Structure, kind_of: Callable[[Mapping[str, int]], _Kind]
    ) -> None:
        self._header = header
        self._kind_of = kind_of
        self._received = bytearray()

    def feed(self, data: bytes) -> Iterator[tuple[_Kind, int, bytes]]:
        """Return the complete messages; the rest waits for more bytes.

        Args:
            data: The next bytes of the stream.

        Returns:
            Kind, number of the request, and body of each message.
        """
        self._received += data
        head_size = self._header.size
        while len(self._received) >= head_size:
            head = self._header.unpack(self._received[:head_size])
            # Checked before the body has come: the size in a foreign head means
            # nothing.
            kind = self._kind_of(head)
            if len(self._received) < head["size"]:
                return
            body = bytes(self._received[head_size : head["size"]])
            del self._received[: head["size"]]
            yield kind, head["command_id"], body

    def pack(self, command: int, command_id: int, body: bytes) -> bytes:
        """Return a message with its head.

        Args:
            command: Number of the command on the wire.
            command_id: Number of the request.
            body: Bytes after the head.
        """
        head = {"command": command, "command_id": command_id}
        return self._header.pack({**head, "size": self._header.size + len(body)}) + body


class Messages(Generic[_Command]):
    """Makes requests, and reads the answers, however TCP has cut them.

    Args:
        header: Head of every message.
        exchanges: Request and answer of every command.
    """

    def __init__(
        self, header: Structure, exchanges: Mapping[_Command, Exchange]
    ) -> None:
        self._header = header
        self._exchanges = exchanges
        self._frames = Frames(header, self._response_of)

    def request(
        self, command: _Command, number: int, values: Mapping[str, Any] = NOTHING
    ) -> bytes:
        """Return a request as bytes.

        Args:
            command: The requested command.
            number: Number of the request, which its answers repeat.
            values: The fields of the request.
        """
        exchange = self._exchanges[command]
        return self._frames.pack(exchange.number, number, exchange.request.pack(values))

    def feed(self, data: bytes) -> Iterator[Answer[_Command]]:
        """Return the answers that are complete now; the rest waits for more bytes.

        Args:
            data: The next bytes of the stream.

        Raises:
            FciProtocolError: A message in the stream is not an answer of the protocol.
        """
        for (command, exchange), number, body in self._frames.feed(data):
            response = exchange.response
            values = response.unpack(body[: response.size])
            status = exchange.status_of(values["status"])
            rest = body[response.size :]
            yield Answer(command, number, status, values, rest)

    def _response_of(self, head: Mapping[str, int]) -> tuple[_Command, Exchange]:
        number = head["command"]
        command = _command_of(self._exchanges, number)
        if command is None:
            raise FciProtocolError(f"libfranka: Unexpected answer to command {number}.")
        exchange = self._exchanges[command]
        if head["size"] < self._header.size + exchange.response.size:
            raise FciProtocolError("libfranka: Incorrect TCP message size.")
        return command, exchange


@dataclass(frozen=True, slots=True)
class Request(Generic[_Command]):
    """One request of a client.

    Attributes:
        command: The requested command.
        command_id: Number of the request, which its answers repeat.
        values: The fields of the request.
    """

    command: _Command
    command_id: int
    values: Mapping[str, Any]


class MessageReader(Generic[_Command]):
    """Reads the requests of one client, however TCP has cut them.

    Args:
        header: Head of every message.
        exchanges: Request and answer of every command.
    """

    def __init__(
        self, header: Structure, exchanges: Mapping[_Command, Exchange]
    ) -> None:
        self._header = header
        self._exchanges = exchanges
        self._frames = Frames(header, self._command_in)

    def feed(self, data: bytes) -> Iterator[Request[_Command]]:
        """Return the requests that are complete now; the rest waits for more bytes.

        Args:
            data: The next bytes of the stream.

        Raises:
            FciProtocolError: A command is unknown, or its size is another one than the
                protocol has.
        """
        for command, number, body in self._frames.feed(data):
            values = self._exchanges[command].request.unpack(body)
            yield Request(command, number, values)

    def answer(
        self,
        request: Request[_Command],
        status: int,
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
        data = exchange.response.pack({"status": number, **values}) + tail
        return self._frames.pack(exchange.number, request.command_id, data)

    def _command_in(self, head: Mapping[str, int]) -> _Command:
        number, size = head["command"], head["size"]
        command = _command_of(self._exchanges, number)
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


def _command_of(exchanges: Mapping[_Command, Exchange], number: int) -> _Command | None:
    """Return the command with a number on the wire; None if there is none."""
    found = (command for command, one in exchanges.items() if one.number == number)
    return next(found, None)
