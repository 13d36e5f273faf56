"""Requests as bytes, and answers out of a stream of bytes: the client's direction."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, Generic, TypeVar

from station.core.errors import StationError
from station.hw.franka.fci.wire.robot_protocol import Exchange
from station.hw.franka.fci.wire.structure import Structure

_Command = TypeVar("_Command", bound=IntEnum)
_NOTHING: Mapping[str, Any] = {}


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
        asked: The version that it asked for.
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
        status: The status, one of those of the command, whatever its number is in the
            version that is spoken; `UNKNOWN` if the version does not have it.
        values: All fields, the status as its number on the wire.
        rest: Bytes behind the fields, e.g. a model library.
    """

    command: _Command
    command_id: int
    status: int
    values: Mapping[str, Any]
    rest: bytes = b""


class FrameCutter:
    """Cuts a stream of TCP bytes into messages, however TCP has cut them.

    Args:
        header: Head of every message.
        check: Refuses the head of a message that the protocol does not have.
    """

    def __init__(
        self, header: Structure, check: Callable[[Mapping[str, int]], object]
    ) -> None:
        self._header = header
        self._check = check
        self._received = bytearray()

    def feed(self, data: bytes) -> Iterator[tuple[Mapping[str, int], bytes]]:
        """Return head and body of complete messages; the rest waits for more bytes.

        Args:
            data: The next bytes of the stream.
        """
        self._received += data
        head_size = self._header.size
        while len(self._received) >= head_size:
            head = self._header.unpack(self._received[:head_size])
            self._check(head)
            if len(self._received) < head["size"]:
                return
            body = bytes(self._received[head_size : head["size"]])
            del self._received[: head["size"]]
            yield head, body


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
        self._cutter = FrameCutter(header, self._response_of)

    def request(
        self, command: _Command, number: int, values: Mapping[str, Any] = _NOTHING
    ) -> bytes:
        """Return a request as bytes.

        Args:
            command: The requested command.
            number: Number of the request, which its answers repeat.
            values: The fields of the request.
        """
        exchange = self._exchanges[command]
        body = exchange.request.pack(values)
        head = {"command": exchange.number, "command_id": number}
        return self._header.pack({**head, "size": self._header.size + len(body)}) + body

    def feed(self, data: bytes) -> Iterator[Answer[_Command]]:
        """Return the answers that are complete now; the rest waits for more bytes.

        Args:
            data: The next bytes of the stream.

        Raises:
            FciProtocolError: The stream has no answer of the protocol in it.
        """
        for head, body in self._cutter.feed(data):
            command, exchange = self._response_of(head)
            response = exchange.response
            values = response.unpack(body[: response.size])
            status = exchange.status_of(values["status"])
            rest = body[response.size :]
            yield Answer(command, head["command_id"], status, values, rest)

    def _response_of(self, head: Mapping[str, int]) -> tuple[_Command, Exchange]:
        number = head["command"]
        command = command_of(self._exchanges, number)
        if command is None:
            raise FciProtocolError(f"libfranka: Unexpected answer to command {number}.")
        exchange = self._exchanges[command]
        if head["size"] < self._header.size + exchange.response.size:
            raise FciProtocolError("libfranka: Incorrect TCP message size.")
        return command, exchange


def command_of(exchanges: Mapping[_Command, Exchange], number: int) -> _Command | None:
    """Return the command with a number on the wire; None if there is none."""
    found = (command for command, one in exchanges.items() if one.number == number)
    return next(found, None)
