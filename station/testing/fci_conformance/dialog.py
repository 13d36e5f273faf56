"""A client of an endpoint: it sends requests, reads states and commands motions.

Source: libfranka@0.15.0 src/robot_impl.cpp, src/control_loop.cpp, the order of requests
and answers; differs: the client neither limits nor filters commands, and reports every
answer.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum
from typing import Any, TypeAlias

from typing_extensions import override

from station.core.franka.franka_errors import error_names
from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.fci.driver.fci_client import RobotAnswer, robot_client
from station.hw.franka.fci.driver.network import FciNetwork, FciNetworkError
from station.hw.franka.fci.wire.robot_protocol import (
    NO_CONTROLLER,
    NO_GENERATOR,
    PROTOCOLS,
    Command,
    ConnectStatus,
    MoveController,
    MoveGenerator,
    MoveStatus,
    RobotProtocol,
)

State: TypeAlias = Mapping[str, Any]
"""The fields of a state by their names on the wire."""
Fields: TypeAlias = Mapping[str, Any]
"""Fields of a command; those that are left out are zero."""
Stream: TypeAlias = Callable[[int, State], Fields | None]
"""Function of a cycle (from 0) and its state that returns the command; None sends none.
"""
Verdict: TypeAlias = tuple[bool, object]
"""Whether a check holds, and the behaviour that it has seen."""

WAIT = 1.0
"""Longest wait for an answer, or for a state, as libfranka's own [s]."""
LONGEST_END = 3.0
"""Longest wait for the end of a motion and of a recovery [s]."""
_REFUSED_FOR = 2.0
"""Longest time for which an endpoint may refuse a client after the last one has left
[s]."""
_PAUSE = 0.02
_SLOWEST = 10.0  # largest ratio of a simulated motion's wall time to its own time
_ROOM = 8192
_DEVIATIONS = (10.0, 3.12, 6.283)


class FciSilenceError(Exception):
    """The endpoint did not send the message that a client waits for."""


@dataclass(frozen=True, slots=True)
class Motion:
    """The modes and the commands of a motion.

    Attributes:
        controller: The controller.
        generator: The motion generator; None for torques only.
        stream: The commands.
    """

    controller: MoveController
    generator: MoveGenerator | None
    stream: Stream

    def without(self, is_left_out: Callable[[int], bool]) -> "Motion":
        """Return the motion without the commands of some cycles."""
        stream = self.stream
        return replace(
            self, stream=lambda n, s: None if is_left_out(n) else stream(n, s)
        )

    def watched(self, look: Callable[[int, State], object]) -> "Motion":
        """Return the motion with a call of `look` before each command."""
        stream = self.stream

        def watch(cycle: int, state: State) -> Fields | None:
            look(cycle, state)
            return stream(cycle, state)

        return replace(self, stream=watch)


@dataclass(slots=True)
class Outcome:
    """The course of a motion.

    Attributes:
        started: The first answer to Move.
        ended: The second answer to Move; None if none came.
        first: The first state that showed the motion; None without one.
        last: The newest state: before the end, and afterwards after the end.
        errors: Names of the errors that ended the motion.
        lowest_rate: Lowest success rate of the states from the 100th cycle on.
    """

    started: int
    ended: int | None = None
    first: State = field(default_factory=dict)
    last: State = field(default_factory=dict)
    errors: Sequence[str] = ()
    lowest_rate: float = 1.0

    @property
    def is_success(self) -> bool:
        """Return whether the motion has ended as its client asked."""
        return self.ended == MoveStatus.SUCCESS

    @property
    def is_clean(self) -> bool:
        """Return whether the motion succeeded, and the states report no error."""
        return self.is_success and not self.errors

    @override
    def __str__(self) -> str:
        """Return the course in words."""
        if self.started != MoveStatus.MOTION_STARTED:
            return f"Move answered with {words(MoveStatus, self.started)}"
        end = "no end" if self.ended is None else words(MoveStatus, self.ended)
        because = f" ({', '.join(self.errors)})" if self.errors else ""
        rate = self.lowest_rate
        late = f"; down to {rate:.0%} of the commands in time" if rate < 1.0 else ""
        return f"{end}{because}{late}"


def words(kind: type[IntEnum], status: int) -> str:
    """Return a status as words, e.g. `reflex aborted`.

    Args:
        kind: The statuses of the command.
        status: One of them, or one that the version does not have.
    """
    known = next((one.name for one in kind if one == status), f"unknown {status}")
    return known.lower().replace("_", " ")


@dataclass(frozen=True, slots=True)
class Endpoint:
    """The address of a robot, the version of its protocol, and whether it may move.

    Attributes:
        host: Name or address.
        port: TCP port.
        protocol: The version of the protocol.
        may_move: Whether the arm may be moved.
    """

    host: str
    port: int
    protocol: RobotProtocol
    may_move: bool = False

    def open(self) -> "Dialog":
        """Return a client that has connected and has received a state.

        Raises:
            OSError: The port is closed, or no answer comes; a `FciNetworkError`.
            FciSilenceError: No state comes.
        """
        dialog = Dialog(open_network(self.host, self.port), self.protocol)
        try:
            dialog.connect()
            dialog.next_state()
        except (OSError, FciSilenceError):
            dialog.close()
            raise
        return dialog


def open_network(host: str, port: int) -> FciNetwork:
    """Return the sockets to an endpoint, which may need a moment to listen again.

    Raises:
        FciNetworkError: The port stays closed for 2 s.
    """
    deadline = time.monotonic() + _REFUSED_FOR
    while True:
        try:
            return FciNetwork(host, port, is_strict=False)
        except FciNetworkError:
            if time.monotonic() > deadline:
                raise
            time.sleep(_PAUSE)


def find_protocol(host: str, port: int, wanted: int | None) -> RobotProtocol:
    """Return a version that an endpoint speaks.

    Args:
        host: Its name or address.
        port: Its TCP port.
        wanted: The version; None for the newest version that this project has a table
            for.

    Raises:
        FciNetworkError: The endpoint does not answer.
        FciSilenceError: The endpoint does not speak the version, or speaks none with a
            table.
    """
    told = 0
    for asked in sorted(PROTOCOLS, reverse=True) if wanted is None else [wanted]:
        status, told = ask_version(host, port, asked)
        if status == ConnectStatus.SUCCESS:
            return PROTOCOLS[asked]
    known = wanted or " or ".join(map(str, PROTOCOLS))
    raise FciSilenceError(
        f"{host}:{port} does not speak version {known}; it answers with {told}."
    )


def ask_version(host: str, port: int, version: int) -> tuple[int, int]:
    """Return the status of Connect for a version, and the version in the answer.

    Raises:
        FciNetworkError: The endpoint does not answer.
    """
    network = open_network(host, port)
    try:
        client = robot_client(network, PROTOCOLS[max(PROTOCOLS)])
        values = {"version": version, "udp_port": network.udp_port}
        answer = client.ask(Command.CONNECT, values)
        return answer.status, answer.values["version"]
    finally:
        network.close()


class Dialog:
    """A connected client. Only one thread may use it.

    Args:
        network: The sockets.
        protocol: The version of the protocol.

    Attributes:
        network: The sockets.
        protocol: The version of the protocol.
        client: Sends requests, and keeps the answers.
        state: The newest state.
        sizes: The sizes of the datagrams that were received [bytes].
        late: Number of states during motions that this client has not answered in time.
    """

    def __init__(self, network: FciNetwork, protocol: RobotProtocol) -> None:
        self.network, self.protocol = network, protocol
        self.client = robot_client(network, protocol)
        self.state: State = {}
        self.sizes: set[int] = set()
        self.late = 0
        self._waited = 0
        self._buffer = bytearray(_ROOM)

    def connect(self) -> None:
        """Connect, and agree on the version.

        Raises:
            FciNetworkError: No answer comes.
            IncompatibleVersionError: The endpoint speaks another version.
        """
        self.client.connect()

    def close(self) -> None:
        """Close the connection."""
        self.network.close()

    def ask(self, command: Command, **values: object) -> RobotAnswer:
        """Send a request, and return its first answer; see `FciClient.ask`."""
        return self.client.ask(command, values)

    def expect(self, command: Command, wanted: IntEnum, **values: object) -> Verdict:
        """Send a request; return whether its status is the wanted one, and the status.

        Args:
            command: The command.
            wanted: The status.
            values: The fields of the request.
        """
        status = self.ask(command, **values).status
        return status == wanted, words(type(wanted), status)

    def next_state(self) -> State:
        """Wait for a state that is newer than the last one, and return it.

        If several states have already come, it returns the newest one, as libfranka
        does.

        Raises:
            FciSilenceError: No state comes within a second.
        """
        deadline = time.monotonic() + WAIT
        layout = self.protocol.state
        size, self._waited = self._drain()
        while time.monotonic() < deadline:
            size = size or self.network.wait(self._buffer)
            if size:
                self.sizes.add(size)
                if size < layout.size:
                    raise FciSilenceError(
                        f"a state of {size} bytes; version {self.protocol.version} has "
                        f"{layout.size}"
                    )
                state = layout.unpack(memoryview(self._buffer)[: layout.size])
                if not self.state or state["message_id"] > self.state["message_id"]:
                    self.state = state
                    return state
            size = 0
        raise FciSilenceError(f"no newer state within {WAIT:g} s")

    def _drain(self) -> tuple[int, int]:
        """Read all datagrams; return the size of the last one, and their number.

        The last datagram stays in the buffer.
        """
        size = count = 0
        while found := self.network.poll(self._buffer):
            self.sizes.add(found)
            size, count = found, count + 1
        return size, count

    def settle(self) -> State:
        """Return the newest state: wait for one that is not older than this call.

        Raises:
            FciSilenceError: No state comes.
        """
        self._drain()
        return self.next_state()

    def wait_until(self, holds: Callable[[State], bool], most: float) -> bool:
        """Read states until one meets a condition; return whether one does.

        Args:
            holds: The condition.
            most: Longest wait [s].

        Raises:
            FciSilenceError: No state comes.
        """
        deadline = time.monotonic() + most
        while not holds(self.state):
            if time.monotonic() > deadline:
                return False
            self.next_state()
        return True

    def start(self, motion: Motion, **values: object) -> tuple[int, RobotAnswer]:
        """Ask for a motion; return the number of the request, and the first answer.

        Raises:
            FciNetworkError: No answer comes.
        """
        request = {
            "controller_mode": motion.controller,
            "motion_generator_mode": self._generator(motion),
            "maximum_path_deviation": _DEVIATIONS,
            "maximum_goal_pose_deviation": _DEVIATIONS,
            **values,
        }
        number = self.client.send(Command.MOVE, request)
        answer = self.client.take_answer(number, WAIT)
        if answer is None:
            raise FciNetworkError("no answer to Move within 1 s")
        return number, answer

    def _generator(self, motion: Motion) -> MoveGenerator:
        """Return the generator; before version 7 a torque motion has one of velocities.

        Source: libfranka@0.9.2 src/robot.cpp, Robot::control.
        """
        if motion.generator is not None:
            return motion.generator
        none = MoveGenerator.NONE
        is_known = none in self.protocol.generators
        return none if is_known else MoveGenerator.JOINT_VELOCITY

    def move(self, motion: Motion, cycles: int, **values: object) -> Outcome:
        """Run a motion to its end, and return its course.

        After the last cycle the client finishes the motion, unless the stream returns
        None then.

        Args:
            motion: The motion.
            cycles: Number of cycles, as the states count them.
            values: Further fields of Move.

        Raises:
            FciNetworkError: The endpoint does not answer.
            FciSilenceError: The endpoint sends no states, or they do not show the
                motion.
        """
        number, answer = self.start(motion, **values)
        outcome = Outcome(answer.status)
        if outcome.started != MoveStatus.MOTION_STARTED:
            return outcome
        generator = self._generator(motion)
        shown = 1 + generator, motion.controller
        if not self.wait_until(lambda s: _modes(s) == shown, WAIT):
            raise FciSilenceError(
                f"the states show the modes {_modes(self.state)} for a motion with "
                f"{shown}"
            )
        is_torque = generator is MoveGenerator.NONE
        finished = f"{'torque_command' if is_torque else 'motion_generation'}_finished"
        self._follow(number, motion.stream, cycles, finished, outcome)
        if outcome.ended is not None:
            idle = NO_GENERATOR, NO_CONTROLLER
            if not self.wait_until(lambda s: _modes(s) == idle, WAIT):
                raise FciSilenceError(
                    f"the states show the modes {_modes(self.state)} after the end"
                )
        outcome.last = self.state
        return outcome

    def _follow(
        self, number: int, stream: Stream, cycles: int, finished: str, outcome: Outcome
    ) -> None:
        state = outcome.first = self.state
        begin = state["message_id"]
        deadline = time.monotonic() + _SLOWEST * cycles / 1000.0 + LONGEST_END
        while time.monotonic() < deadline:
            cycle = state["message_id"] - begin
            values = stream(min(cycle, cycles), state)
            if values is not None:
                self.command({finished: cycle >= cycles, **values})
            answer = self.client.take_answer(number)
            if answer is None:
                before, state = state["message_id"], self.next_state()
                # A state that was waiting had come before the last one was answered.
                self.late += state["message_id"] - before - 1 + (self._waited > 0)
                answer = self.client.take_answer(number)
            if cycle >= 100 and state["robot_mode"] == RobotMode.MOVE.value:
                rate = state["control_command_success_rate"]
                outcome.lowest_rate = min(outcome.lowest_rate, rate)
            if answer is not None:
                outcome.ended = answer.status
                break
        # Only the state with the end of the motion may be waiting.
        self.late += max(0, self._drain()[1] - 1)
        if outcome.ended not in (MoveStatus.SUCCESS, None):
            self.wait_until(has_errors, 0.1)
        outcome.errors = error_names(self.state["reflex_reason"])

    def command(self, values: Fields) -> None:
        """Send a command that answers the newest state."""
        message = {"message_id": self.state["message_id"], **values}
        self.network.send_datagram(bytearray(self.protocol.command.pack(message)))


def has_errors(state: State) -> bool:
    """Return whether a state shows errors of the last motion."""
    return any(state["reflex_reason"])


def _modes(state: State) -> tuple[int, int]:
    return state["motion_generator_mode"], state["controller_mode"]
