"""The link to an arm: its states as they arrive, its answers, and its loss."""

import contextlib
import socket
import threading
import time
from collections.abc import Callable, Mapping
from typing import Any

from station.core.errors import ArmCommandError, InvalidCommandError, StationError
from station.core.franka.franka_robot_state import RobotMode, RobotState
from station.hw.franka.fci.driver.fci_client import Connection, RobotAnswer, connect
from station.hw.franka.fci.driver.network import (
    SLICE,
    UDP_TIMEOUT,
    FciNetwork,
    FciNetworkError,
)
from station.hw.franka.fci.driver.refusals import REMEDIES, refusal_of
from station.hw.franka.fci.driver.state_reader import CYCLE_TIME, StateReader
from station.hw.franka.fci.wire.messages import NOTHING, FciProtocolError
from station.hw.franka.fci.wire.robot_protocol import (
    Command,
    RobotProtocol,
    Status,
)


class Reconnection:
    """Opens new connections, in a thread of its own, when the control thread asks.

    An attempt to connect may fail only after seconds. The control thread asks for a
    connection here, and finds it here later; it never waits.

    Args:
        open_network: Opens a connection.
        protocol: The version that is spoken.
    """

    def __init__(
        self, open_network: Callable[[], FciNetwork], protocol: RobotProtocol
    ) -> None:
        self._open_network, self._protocol = open_network, protocol
        self._settings: list[tuple[Command, Mapping[str, Any]]] = []
        self._found: Connection[Command] | str | None = None
        self._word, self._ear = socket.socketpair()
        self._word.settimeout(0.0)
        self._thread = threading.Thread(target=self._run, name="connect", daemon=True)
        self._thread.start()

    def ask(self, settings: list[tuple[Command, Mapping[str, Any]]]) -> None:
        """Ask the thread for a new connection.

        Args:
            settings: Requests to send once the arm is connected.
        """
        self._found, self._settings = None, settings
        # A full socket already holds the byte that wakes the thread.
        with contextlib.suppress(BlockingIOError):
            self._word.send(b"\0")

    def take_connection(self) -> Connection[Command] | str | None:
        """Return, once, a new connection or why it failed; None without either."""
        found, self._found = self._found, None
        return found

    def close(self) -> None:
        """End the thread, and close connections that were not taken over."""
        self._word.close()
        self._thread.join()
        self._ear.close()
        if isinstance(self._found, Connection):
            self._found.network.close()

    def _run(self) -> None:
        while self._ear.recv(1):
            try:
                self._found = self._connect()
            except StationError as error:
                self._found = error.message

    def _connect(self) -> Connection[Command]:
        """Connect, and send the settings.

        Raises:
            StationError: The arm does not answer (`FciNetworkError`), or speaks another
                version (`FciProtocolError`).
            FciNetworkError: The arm refuses a setting.
        """
        made = connect(self._open_network(), self._protocol)
        try:
            for command, values in self._settings:
                answer = made.client.ask(command, values)
                if answer.status is not Status.SUCCESS:
                    raise FciNetworkError(refusal_of(answer, RobotMode.OTHER))
        except StationError:
            made.network.close()
            raise
        return made


class ArmLink:
    """Receives states and sends requests, until the arm is lost. Control thread.

    A lost arm is connected to again on request, by another thread.

    Args:
        network: The connection to the arm.
        protocol: The version that is spoken.
        state: The state to keep up to date.
        on_state: Called after every state but the first of a connection.
        on_loss: Called when the arm is lost.
        reopen: Opens a new connection to the arm; None for an arm that stays lost.

    Attributes:
        reader: The newest state's number and modes.
        loss: Why the arm is lost; None while it is there.
        is_returning: Whether a new connection to a lost arm is being made.

    Raises:
        FciNetworkError: The arm does not answer.
        FciProtocolError: The arm does not speak this version.
    """

    def __init__(
        self,
        network: FciNetwork,
        protocol: RobotProtocol,
        state: RobotState,
        *,
        on_state: Callable[[], None],
        on_loss: Callable[[], None],
        reopen: Callable[[], FciNetwork] | None = None,
    ) -> None:
        self._on_state, self._on_loss = on_state, on_loss
        self.reader = StateReader(state, protocol)
        self.loss: str | None = None
        self.is_returning = False
        self._counted = 0  # message_id up to which `count` has counted
        self._take(connect(network, protocol))
        self._reconnection = reopen and Reconnection(reopen, protocol)

    def begin_return(self, settings: list[tuple[Command, Mapping[str, Any]]]) -> None:
        """Ask for a new connection to a lost arm; `receive_return` takes it over.

        Args:
            settings: Requests that follow the connection.

        Raises:
            ArmCommandError: Nothing can open a new connection: this arm stays lost.
        """
        if self._reconnection is None:
            raise self._told()
        if not self.is_returning:
            self.is_returning = True
            self._reconnection.ask(settings)

    def receive_return(self) -> bool:
        """Take a new connection over, if any; return whether there was one.

        If the attempt failed, `loss` becomes its reason.
        """
        found = self._reconnection and self._reconnection.take_connection()
        if not found:
            return False
        self.is_returning = False
        if isinstance(found, str):
            self.loss = found
            return False
        self._take(found)
        return True

    def receive(self) -> bool:
        """Wait for a newer state, `SLICE` at most; return whether one has come.

        States that have piled up are passed over, as in libfranka. In place of waiting
        for a lost arm, sleep for a cycle.
        """
        if self.loss is not None:
            time.sleep(CYCLE_TIME)
            return False
        reader, network = self.reader, self._network
        size = network.wait(reader.message)
        if not reader.is_newer(size):
            if not size:
                self._note_silence()
            return False
        self._read()
        if reader.message_id > self._counted + 1:
            while size := network.poll(reader.message):
                if reader.is_newer(size):
                    self._read()
        return True

    def receive_next(self) -> None:
        """Wait for a newer state, as long as an arm may be silent."""
        while self.loss is None and not self.receive():
            pass

    def count(self) -> int:
        """Return the elapsed cycles since the last call; always 1 for a lost arm."""
        elapsed = self.reader.message_id - self._counted
        self._counted = self.reader.message_id
        return elapsed if self.loss is None else 1

    def send_command(self, message: bytearray) -> None:
        """Send a command; a datagram that the network does not take is lost."""
        self._network.send_datagram(message)

    def send(self, command: Command) -> int:
        """Send a request without fields; return its number.

        Raises:
            ArmCommandError: The arm is lost.
        """
        self.check()
        try:
            return self._client.send(command)
        except FciNetworkError as error:
            raise self._lose(error) from error

    def ask(self, command: Command, values: Mapping[str, Any] = NOTHING) -> RobotAnswer:
        """Send a request and return the first answer.

        Raises:
            ArmCommandError: The arm is lost.
        """
        self.check()
        try:
            return self._client.ask(command, values)
        except (FciNetworkError, FciProtocolError) as error:
            raise self._lose(error) from error

    def change(self, command: Command, values: Mapping[str, Any]) -> None:
        """Change a setting, and wait for a state that shows it.

        Raises:
            ArmCommandError: The arm is lost or refuses.
            InvalidCommandError: The arm refuses the value.
        """
        answer = self.ask(command, values)
        if answer.status is Status.INVALID_ARGUMENT_REJECTED:
            raise InvalidCommandError(
                refusal_of(answer, self.reader.robot_mode),
                remedy="Give values that this arm allows.",
            )
        if answer.status is not Status.SUCCESS:
            raise self.refused(answer)
        self.receive_next()

    def refused(self, answer: RobotAnswer) -> ArmCommandError:
        """Return the error for an answer that is not a success."""
        mode = self.reader.robot_mode
        todo = REMEDIES.get(mode, "stop the running motion, then try again")
        return ArmCommandError(
            refusal_of(answer, mode), remedy=f"{todo[0].upper()}{todo[1:]}."
        )

    def forget(self, number: int) -> None:
        """Drop the answers to a request, also those that are still to come."""
        self._client.forget(number)

    def take_answer(self, number: int) -> RobotAnswer | None:
        """Return the next answer to a request if it is there; the arm may get lost."""
        if self.loss is not None:
            return None
        try:
            return self._client.take_answer(number)
        except (FciNetworkError, FciProtocolError) as error:
            self._lose(error)
            return None

    def close(self) -> None:
        """Close the connection."""
        if self._reconnection is not None:
            self._reconnection.close()
        self._network.close()

    def _take(self, connection: Connection[Command]) -> None:
        """Go on with a new connection, whose first state nobody is told of."""
        self._network, self._client = connection.network, connection.client
        self.reader.begin(connection.state)
        self._counted = self.reader.message_id
        self._silence, self.loss = 0.0, None

    def _read(self) -> None:
        self.reader.read()
        self._silence = 0.0
        self._on_state()

    def _note_silence(self) -> None:
        self._silence += SLICE
        if self._silence >= UDP_TIMEOUT:
            self._lose(FciNetworkError("libfranka: UDP receive: Timeout"))

    def check(self) -> None:
        """Raise an error if the arm is lost.

        Raises:
            ArmCommandError: The arm is lost.
        """
        if self.loss is not None:
            raise self._told()

    def _lose(self, error: StationError) -> ArmCommandError:
        """Give the arm up; return the error for the caller."""
        self.loss = error.message
        # The arm takes one client: it must see that this one has gone.
        self._network.close()
        self._on_loss()
        return self._told()

    def _told(self) -> ArmCommandError:
        return ArmCommandError(
            f"The arm is lost: {self.loss}.",
            remedy="Restore the connection, then recover the arm.",
        )
