"""The link to a hand: a thread of its own, which connects, sends and waits.

A request to a hand is answered when the fingers have come to rest, after seconds. The
control thread leaves an order here and reads its result; it never waits.
"""

import contextlib
import logging
import socket
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from station.core.errors import StationError
from station.hw.franka.fci.driver.fci_client import Connection, FciClient, connect
from station.hw.franka.fci.driver.network import (
    UDP_TIMEOUT,
    FciNetwork,
    FciNetworkError,
)
from station.hw.franka.fci.wire.gripper_protocol import HAND, HandCommand
from station.hw.franka.fci.wire.messages import FciProtocolError
from station.hw.franka.fci.wire.robot_protocol import Status
from station.local.descriptors import wait_until_readable

LOOK = 0.1
"""Time between two looks at the states of a hand [s]. Source: franka_ros@c11f000
franka_gripper/src/franka_gripper_node.cpp, `read_rate`."""
RETRY = 2.0
"""Time between two attempts to connect to a hand [s]."""
_CLOSED = "the driver is closed"

_logger = logging.getLogger(__name__)


@dataclass(slots=True)
class HandOrder:
    """A command that the hand is to carry out, and its outcome.

    Attributes:
        command: The command.
        values: The fields of the request.
        outcome: The hand's answer, or the reason why the hand was lost before; None
            while the order waits or runs. The thread of the link sets it once.
    """

    command: HandCommand
    values: Mapping[str, Any]
    outcome: Status | str | None = None


class HandLink:
    """Keeps a connection to a hand and carries out the newest order.

    A hand that is lost is connected to again every `RETRY` seconds. A motion that runs
    is stopped before a newer order is sent.

    Threads: `order` and the attributes are for the control thread; `serve_orders` is
    for the thread of the link, which `start` begins.

    Args:
        open_network: Opens a connection to the hand.
        clock: Wall time [s].
        pause: Waits until bytes of the hand or an order arrive, at most for the given
            time [s].

    Attributes:
        problem: Why there is no hand; None while it is there.
        state: The newest state of the hand, by field; None before the first one.
        on_state: Called by the thread of the link with every new state.
    """

    def __init__(
        self,
        open_network: Callable[[], FciNetwork],
        *,
        clock: Callable[[], float] = time.monotonic,
        pause: "Callable[[FciNetwork | None, float], None] | None" = None,
    ) -> None:
        self._open_network = open_network
        self._clock = clock
        self._pause = pause or self._wait
        self._word, self._ear = socket.socketpair()
        self._word.settimeout(0.0)
        self._ear.settimeout(0.0)
        self._buffer = bytearray(HAND.state.size + 1)
        self._connection: Connection[HandCommand] | None = None
        self._orders: deque[HandOrder] = deque()
        self._next: HandOrder | None = None
        self._running: tuple[int, HandOrder] | None = None  # with its request
        self._stop: int | None = None
        self._heard = 0.0
        self._next_try = 0.0
        self._thread: threading.Thread | None = None
        self._is_closing = False
        self.problem: str | None = "the hand was not connected to yet"
        self.state: Mapping[str, Any] | None = None
        self.on_state: Callable[[Mapping[str, Any]], None] = lambda _state: None

    def start(self) -> None:
        """Try to connect, and go on in a thread of the link."""
        self.serve_orders()
        self._thread = threading.Thread(target=self._run, name="hand", daemon=True)
        self._thread.start()

    def order(self, order: HandOrder) -> None:
        """Leave an order, which replaces earlier orders. Does not wait."""
        self._orders.append(order)
        # A full socket already holds the byte that wakes the thread.
        with contextlib.suppress(BlockingIOError):
            self._word.send(b"\0")

    def close(self) -> None:
        """Stop the fingers if they move, and close the connection; may be repeated."""
        if self._is_closing:
            return
        self._is_closing = True
        with contextlib.suppress(BlockingIOError):
            self._word.send(b"\0")
        if self._thread is not None:
            self._thread.join()
        if self._connection is not None and self._running is not None:
            with contextlib.suppress(FciNetworkError):
                self._connection.client.send(HandCommand.STOP)
        self._lose(_CLOSED)
        self._word.close()
        self._ear.close()

    def serve_orders(self) -> None:
        """Carry out the waiting orders, then wait for more."""
        connection = self._connection
        if connection is None:
            while self._orders:
                self._orders.popleft().outcome = self.problem
            left = self._next_try - self._clock()
            if left > 0.0:
                self._pause(None, left)
            else:
                self._connect()
            return
        try:
            self._take_answers(connection.client)
            self._carry_out(connection.client)
            self._take_states(connection.network)
        except (FciNetworkError, FciProtocolError) as error:
            self._lose(error.message)
        else:
            self._pause(connection.network, LOOK)

    def _run(self) -> None:
        while not self._is_closing:
            self.serve_orders()

    def _wait(self, network: FciNetwork | None, longest: float) -> None:
        readers = [self._ear.fileno()]
        if network is not None:
            readers.append(network.fileno())
        wait_until_readable(readers, longest)
        with contextlib.suppress(BlockingIOError):
            self._ear.recv(4096)

    def _connect(self) -> None:
        try:
            self._connection = connect(self._open_network(), HAND)
        except StationError as error:
            self._lose(error.message)
            return
        self._read(self._connection.state)
        self.problem = None
        _logger.info("The hand is connected.")

    def _take_states(self, network: FciNetwork) -> None:
        """Read the newest state.

        Raises:
            FciNetworkError: No state has come for too long.
        """
        size, state = HAND.state.size, b""
        while found := network.poll(self._buffer):
            state = bytes(self._buffer[:size]) if found == size else b""
        if state:
            self._read(state)
        elif self._clock() - self._heard >= UDP_TIMEOUT:
            raise FciNetworkError("libfranka: UDP receive: Timeout")

    def _read(self, message: bytes) -> None:
        self.state = state = HAND.state.unpack(message)
        self._heard = self._clock()
        self.on_state(state)

    def _take_answers(self, client: FciClient[HandCommand]) -> None:
        if self._stop is not None and client.take_answer(self._stop) is not None:
            self._stop = None
        if self._running is not None:
            number, order = self._running
            answer = client.take_answer(number)
            if answer is not None:
                self._running = None
                order.outcome = answer.status

    def _carry_out(self, client: FciClient[HandCommand]) -> None:
        """Send the newest order, or first a stop of the motion that runs."""
        while self._orders:
            self._next = self._orders.popleft()
        order = self._next
        if order is None or self._stop is not None:
            return
        if order.command is HandCommand.STOP:
            self._stop = client.send(HandCommand.STOP)
            self._next = None
        elif self._running is not None:
            self._stop = client.send(HandCommand.STOP)
        else:
            self._running = client.send(order.command, order.values), order
            self._next = None

    def _lose(self, problem: str) -> None:
        """Give the hand up for some time, and end its order."""
        connection, self._connection = self._connection, None
        if connection is not None:
            connection.network.close()
        if self._running is not None:
            self._running[1].outcome = problem
        if self._next is not None:
            self._next.outcome = problem
        self._running = self._next = self._stop = None
        if problem not in {self.problem, _CLOSED}:
            _logger.warning("There is no hand: %s", problem)
        self.problem, self.state = problem, None
        self._next_try = self._clock() + RETRY
