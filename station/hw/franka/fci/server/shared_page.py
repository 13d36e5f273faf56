"""The memory that a control thread shares with the process that serves its clients.

A control thread may not send or receive. It leaves messages here and finds commands
here; another process moves them to and from the network. Nobody locks: each kind of
message has two places. A message is written into the place that is not valid, and
becomes valid by its number. Each number has one writer. The writer of two messages
more writes where a reader may still copy: the reader then takes the newer message.
"""

import mmap

from station.hw.franka.fci.wire.robot_protocol import PROTOCOLS

_NUMBERS = 128
_SLOT = 4096
_STATE, _COMMAND, _ANSWERS = 0, 1, 2
_SIZES = 8
_COPIES = 3
"""How often a reader copies at most; it need not copy twice unless it was held up."""
PAGE_BYTES = _NUMBERS + 6 * _SLOT
"""Size of the shared memory [bytes]."""


class SharedPage:
    """Carries states and answers in one direction, commands in the other.

    Args:
        memory: At least `PAGE_BYTES` writable bytes from `start` on, zero at first.
        start: Offset of the page in the memory [bytes].
    """

    def __init__(self, memory: mmap.mmap | bytearray, start: int = 0) -> None:
        view = memoryview(memory)[start:]
        self._numbers = view[:_NUMBERS].cast("Q")
        self._slots = [
            view[_NUMBERS + i * _SLOT : _NUMBERS + (i + 1) * _SLOT] for i in range(6)
        ]
        self._command_sizes = {one.command.size for one in PROTOCOLS.values()}
        # Numbers of the last state and command that this side has taken.
        self._taken = {_STATE: 0, _COMMAND: 0}

    def put_state(self, message: bytes | bytearray) -> None:
        """Leave a state; an older one that was not taken is lost. Control thread."""
        self._put(_STATE, message)

    def take_state(self) -> bytes | None:
        """Return the newest state if it is a new one. Server's process."""
        return self._take(_STATE)

    def put_command(self, datagram: bytes) -> None:
        """Leave a command; drop bytes of another length. Server's process."""
        if len(datagram) in self._command_sizes:
            self._put(_COMMAND, datagram)

    def take_command(self) -> bytes | None:
        """Return the newest command if it is a new one. Control thread."""
        return self._take(_COMMAND)

    def put_answers(self, data: bytes) -> bool:
        """Leave answers, at most 4 KB; return whether there was room. Control thread.

        There is room once the last answers have been taken.
        """
        if self._numbers[_ANSWERS] != self._numbers[_SIZES - 1]:
            return False
        self._put(_ANSWERS, data)
        return True

    def take_answers(self) -> bytes:
        """Return the answers that were left, or no bytes. Server's process."""
        number = self._numbers[_ANSWERS]
        if number == self._numbers[_SIZES - 1]:
            return b""
        data = self._find(_ANSWERS, number)
        self._numbers[_SIZES - 1] = number
        return data

    def _take(self, kind: int) -> bytes | None:
        for _ in range(_COPIES):
            number = self._numbers[kind]
            if number == self._taken[kind]:
                return None
            data = self._find(kind, number)
            # Another number by now: the next message may be in this place already.
            if self._numbers[kind] == number:
                self._taken[kind] = number
                return data
        return None

    def _put(self, kind: int, data: bytes | bytearray) -> None:
        number = self._numbers[kind] + 1
        self._slots[2 * kind + number % 2][: len(data)] = data
        self._numbers[_SIZES + 2 * kind + number % 2] = len(data)
        self._numbers[kind] = number

    def _find(self, kind: int, number: int) -> bytes:
        size = self._numbers[_SIZES + 2 * kind + number % 2]
        return bytes(self._slots[2 * kind + number % 2][:size])
