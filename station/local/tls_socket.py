"""A TLS socket that one thread reads while another thread writes.

OpenSSL forbids to read and write one connection at the same time, and Python 3.11 does
not prevent it: requests and frames can be lost. A WebSocket of a program without
asyncio has one thread that reads and one that writes.
"""

import select
import ssl
import threading
import time
from collections.abc import Callable
from typing import Any, Self, TypeVar

from typing_extensions import Buffer, override

_LONGEST_WAIT = 1.0
"""Time after which a thread that waits looks at the connection again [s]."""
_Result = TypeVar("_Result")


class TlsSocket(ssl.SSLSocket):
    """Reads and writes in turns, and waits for the network outside of its turn.

    `wrap_socket` of a context makes it whose `sslsocket_class` it is.
    """

    _sslobj: object | None
    _turn: threading.Lock
    _timeout: float | None
    _is_open: bool

    def __new__(cls, *_given: object, **_named: object) -> Self:
        """Make a socket; `wrap_socket` does not call `__init__`."""
        made = super().__new__(cls)
        made._turn = threading.Lock()
        made._timeout = None
        made._is_open = False
        return made

    @override
    def do_handshake(self, block: bool = False) -> None:
        """Agree on keys, and let no call wait inside of OpenSSL from then on."""
        super().do_handshake(block)
        self._timeout = super().gettimeout()
        self._is_open = True
        super().settimeout(0.0)

    @override
    def settimeout(self, value: float | None) -> None:
        """Set how long a call may wait [s]; None waits for ever."""
        self._timeout = value
        if not self._is_open:
            super().settimeout(value)

    @override
    def gettimeout(self) -> float | None:
        """Return how long a call may wait [s]."""
        return self._timeout if self._is_open else super().gettimeout()

    @override
    def read(self, len: int = 1024, buffer: Any = None) -> Any:
        """Return what has come, at least a byte, or its size if it goes to a buffer.

        Nothing comes any more once `shutdown` was called.

        Raises:
            TimeoutError: Nothing came in time.
        """
        read = super().read

        def take() -> bytes | int:
            if self._sslobj is None:  # another thread has ended the connection
                return b"" if buffer is None else 0
            return read(len, buffer)

        return self._in_turn(take)

    @override
    def send(self, data: Buffer, flags: int = 0) -> int:
        """Send at least a byte; return how many.

        Raises:
            TimeoutError: Nothing could be sent in time.
        """
        send = super().send
        return self._in_turn(lambda: send(data, flags))

    @override
    def shutdown(self, how: int) -> None:
        """End reading, writing or both; a thread that waits for data goes on."""
        with self._turn:
            super().shutdown(how)

    def _in_turn(self, act: Callable[[], _Result]) -> _Result:
        """Do something as soon as neither the other thread nor the network bars it.

        Raises:
            TimeoutError: That took too long.
        """
        limit = self._timeout
        deadline = None if limit is None else time.monotonic() + limit
        while True:
            with self._turn:
                try:
                    return act()
                except ssl.SSLWantReadError:
                    event = select.POLLIN
                except ssl.SSLWantWriteError:
                    event = select.POLLOUT
            left = _LONGEST_WAIT
            if deadline is not None:
                left = min(left, deadline - time.monotonic())
                if left <= 0.0:
                    raise TimeoutError("timed out")
            self._wait(event, left)

    def _wait(self, event: int, seconds: float) -> None:
        poll: Any = select.poll()
        poll.register(self.fileno(), event)
        poll.poll(1000.0 * seconds)
