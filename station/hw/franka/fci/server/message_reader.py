"""Cut a stream of TCP bytes into requests, and put answers together."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import IntEnum
from types import MappingProxyType
from typing import Any, Generic, TypeVar

from station.hw.franka.fci.wire.messages import (
    FciProtocolError,
    FrameCutter,
    command_of,
)
from station.hw.franka.fci.wire.robot_protocol import Exchange
from station.hw.franka.fci.wire.structure import Structure

_Command = TypeVar("_Command", bound=IntEnum)
_NOTHING: Mapping[str, Any] = MappingProxyType({})


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
        self._cutter = FrameCutter(header, self._command_of)

    def feed(self, data: bytes) -> Iterator[Request[_Command]]:
        """Return the requests that are complete now; the rest waits for more bytes.

        Args:
            data: The next bytes of the stream.

        Raises:
            FciProtocolError: A command is unknown, or its size is another one than the
                protocol has.
        """
        for head, body in self._cutter.feed(data):
            command = self._command_of(head)
            values = self._exchanges[command].request.unpack(body)
            yield Request(command, head["command_id"], values)

    def answer(
        self,
        request: Request[_Command],
        status: int,
        values: Mapping[str, Any] = _NOTHING,
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
        head = {"command": exchange.number, "command_id": request.command_id}
        return self._header.pack({**head, "size": self._header.size + len(data)}) + data

    def _command_of(self, head: Mapping[str, int]) -> _Command:
        number, size = head["command"], head["size"]
        command = command_of(self._exchanges, number)
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
