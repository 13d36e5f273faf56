"""A client of an endpoint: it sends requests, reads states and commands motions.

Source: libfranka@0.15.0 src/robot_impl.cpp, src/control_loop.cpp, the order of requests
and answers; differs: the client neither limits nor filters commands, and reports every
answer. Answers are told in words, e.g. `success` or `reflex aborted`.
"""

import time
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from math import inf, sqrt
from typing import TypeAlias

from typing_extensions import override

from station.core.errors import StationError
from station.core.franka.franka_errors import error_names
from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.fci.driver.fci_client import FciClient, RobotAnswer
from station.hw.franka.fci.driver.network import FciNetwork, FciNetworkError
from station.hw.franka.fci.wire.robot_protocol import (
    NO_CONTROLLER,
    NO_GENERATOR,
    PROTOCOLS,
    Command,
    MoveGenerator,
    RobotProtocol,
)
from station.testing.fci_conformance.trajectories import (
    START,
    Motion,
    State,
    farthest,
    glide,
)

STARTED, SUCCESS = "motion started", "success"
"""Answers that the checks ask for most."""
SUCCESS_RATE = "control_command_success_rate"
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
_SPEED = (1.0, 1.0, 1.0, 1.0, 1.6, 1.6, 1.6)  # [rad/s]
_ACCELERATION = 5.0  # [rad/s^2]
_SHORTEST = 0.2  # [s]
_THERE = 0.02
_STILL = 1e-3  # [rad/s]
_SLOWEST = 10.0  # largest ratio of a simulated motion's wall time to its own time
_ROOM = 8192
_DEVIATIONS = (10.0, 3.12, 6.283)


class FciSilenceError(Exception):
    """The endpoint did not send the message that a client waits for."""


@dataclass(slots=True)
class Outcome:
    """The course of a motion.

    Attributes:
        started: The first answer to Move.
        ended: The second answer to Move; None if none came.
        states: The states while the motion ran, by their cycles from 0 on.
        sent: The cycles in which a command was sent.
        first: The first state that showed the motion; empty without one.
        last: The newest state after the end.
        errors: Names of the errors that ended the motion.
    """

    started: str
    ended: str | None = None
    states: dict[int, State] = field(default_factory=dict)
    sent: list[int] = field(default_factory=list)
    first: State = field(default_factory=dict)
    last: State = field(default_factory=dict)
    errors: Sequence[str] = ()

    @property
    def is_success(self) -> bool:
        """Return whether the motion has ended as its client asked."""
        return self.ended == SUCCESS

    @property
    def is_clean(self) -> bool:
        """Return whether the motion succeeded, and the states report no error."""
        return self.is_success and not self.errors

    @property
    def lowest_rate(self) -> float:
        """Lowest success rate of the states after cycle 100."""
        later = (state for cycle, state in self.states.items() if cycle > 100)
        moving = (one for one in later if one["robot_mode"] == RobotMode.MOVE.value)
        return min((one[SUCCESS_RATE] for one in moving), default=1.0)

    @override
    def __str__(self) -> str:
        """Return the course in words."""
        if self.started != STARTED:
            return f"Move answered with {self.started}"
        because = f" ({', '.join(self.errors)})" if self.errors else ""
        rate = self.lowest_rate
        late = f"; down to {rate:.0%} of the commands in time" if rate < 1.0 else ""
        return f"{self.ended or 'no end'}{because}{late}"


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
        """Return a client that has connected and has received a state; see `Dialog`."""
        return Dialog(open_network(self.host, self.port), self.protocol)


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
    version = 0
    for asked in sorted(PROTOCOLS, reverse=True) if wanted is None else [wanted]:
        status, version = ask_version(host, port, asked)
        if status == SUCCESS:
            return PROTOCOLS[asked]
    known = wanted or " or ".join(map(str, PROTOCOLS))
    raise FciSilenceError(
        f"{host}:{port} does not speak version {known}; it answers with {version}."
    )


def ask_version(host: str, port: int, version: int) -> tuple[str, int]:
    """Return the answer to Connect with a version, and the version in the answer.

    Raises:
        FciNetworkError: The endpoint does not answer.
    """
    with closing(open_network(host, port)) as network:
        client = FciClient(network, PROTOCOLS[max(PROTOCOLS)])
        values = {"version": version, "udp_port": network.udp_port}
        answer = client.ask(Command.CONNECT, values)
        return answer.words, answer.values["version"]


class Dialog:
    """A client that has connected and has received a state. Only one thread may use it.

    Args:
        network: The sockets, which the dialog closes.
        protocol: The version of the protocol.

    Attributes:
        network: The sockets.
        protocol: The version of the protocol.
        client: Sends requests, and keeps the answers.
        state: The newest state.
        sizes: The sizes of the datagrams that were received [bytes].
        late: Number of states during motions that this client has not answered in time.

    Raises:
        StationError: No answer comes (`FciNetworkError`), or the endpoint speaks
            another version (`IncompatibleVersionError`).
        FciSilenceError: No state comes.
    """

    def __init__(self, network: FciNetwork, protocol: RobotProtocol) -> None:
        self.network, self.protocol = network, protocol
        self.client = FciClient(network, protocol)
        self.state: State = {}
        self.sizes: set[int] = set()
        self.late = 0
        self._waited = 0
        self._buffer = bytearray(_ROOM)
        try:
            self.client.connect()
            self.next_state()
        except (StationError, FciSilenceError):
            self.close()
            raise

    def close(self) -> None:
        """Close the connection."""
        self.network.close()

    def ask(self, command: Command, **values: object) -> RobotAnswer:
        """Send a request, and return its first answer; see `FciClient.ask`."""
        return self.client.ask(command, values)

    def expect(self, command: Command, wanted: str, **values: object) -> Verdict:
        """Send a request; return whether the answer is the wanted one, and the answer.

        Args:
            command: The command.
            wanted: The status in words.
            values: The fields of the request.
        """
        answer = self.ask(command, **values).words
        return answer == wanted, answer

    def next_state(self) -> State:
        """Wait for a state that is newer than the last one, and return it.

        If several states have already come, it returns the newest one, as libfranka
        does.

        Raises:
            FciSilenceError: No state comes within a second.
        """
        deadline = time.monotonic() + WAIT
        version, layout = self.protocol.version, self.protocol.state
        size, self._waited = self._drain()
        while time.monotonic() < deadline:
            size = size or self.network.wait(self._buffer)
            if size:
                self.sizes.add(size)
                if size < layout.size:
                    raise FciSilenceError(
                        f"a state of {size} bytes; version {version} has {layout.size}"
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

    def start(self, motion: Motion, **values: object) -> RobotAnswer:
        """Ask for a motion; return the first answer.

        Args:
            motion: The motion.
            values: Further fields of Move.
        """
        return self.ask(
            Command.MOVE,
            controller_mode=motion.controller,
            motion_generator_mode=motion.generator,
            maximum_path_deviation=_DEVIATIONS,
            maximum_goal_pose_deviation=_DEVIATIONS,
            **values,
        )

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
        # Before version 7 a motion of torques has a generator of velocities. Source:
        # libfranka@0.9.2 src/robot.cpp, Robot::control.
        if motion.generator not in self.protocol.generators:
            motion = replace(motion, generator=MoveGenerator.JOINT_VELOCITY)
        answer = self.start(motion, **values)
        outcome = Outcome(answer.words)
        if outcome.started != STARTED:
            return outcome
        outcome.ended = self._await_begin(answer.command_id, motion)
        self._follow(answer.command_id, motion, cycles, outcome)
        if outcome.ended not in {SUCCESS, None}:
            self.wait_until(lambda state: any(state["reflex_reason"]), 0.1)
        outcome.errors = error_names(self.state["reflex_reason"])
        if outcome.ended is not None:
            self._await_modes(NO_GENERATOR, NO_CONTROLLER)
        outcome.last = self.state
        return outcome

    def _await_begin(self, number: int, motion: Motion) -> str | None:
        """Wait until the states show a motion; return its end if it ended before.

        Args:
            number: Number of the request.
            motion: The motion.

        Raises:
            FciSilenceError: The states show neither the motion nor an error.
        """
        wanted = 1 + motion.generator, motion.controller
        reflex = RobotMode.REFLEX.value
        self.wait_until(
            lambda one: _modes(one) == wanted or one["robot_mode"] == reflex, WAIT
        )
        answer = None
        if self.state["robot_mode"] == reflex:
            answer = self.client.take_answer(number, WAIT)
        if answer is None:
            self._await_modes(*wanted)
        return None if answer is None else answer.words

    def _await_modes(self, *wanted: int) -> None:
        """Wait until the states show a motion generator and a controller.

        Raises:
            FciSilenceError: They do not.
        """
        if not self.wait_until(lambda state: _modes(state) == wanted, WAIT):
            raise FciSilenceError(
                f"the states show the modes {_modes(self.state)} instead of {wanted}"
            )

    def recover(self) -> str:
        """Recover once; return `idle` if the arm is idle then, else the answer.

        Raises:
            FciNetworkError: No answer comes.
        """
        number = self.client.send(Command.AUTOMATIC_ERROR_RECOVERY)
        answer = self.client.take_answer(number, LONGEST_END)
        if answer is None or answer.words != SUCCESS:
            silence = f"no answer within {LONGEST_END:g} s"
            return silence if answer is None else answer.words
        if not self.wait_until(lambda s: s["robot_mode"] == RobotMode.IDLE.value, 1.0):
            return f"success, and robot mode {self.state['robot_mode']}"
        is_clear = not any(self.state["errors"])
        return "idle" if is_clear else "success, and the errors are still there"

    def go_to(self, q: Sequence[float] = START) -> None:
        """Move the joints slowly to a pose; recover from a reflex first if necessary.

        Raises:
            FciNetworkError: The endpoint does not answer.
            FciSilenceError: The arm does not arrive.
        """
        if self.settle()["robot_mode"] != RobotMode.IDLE.value:
            self.recover()
        # The arm may still be slowing down from the last motion.
        self.wait_until(lambda s: max(map(abs, s["dq_d"])) < _STILL, 1.0)
        way = [goal - now for goal, now in zip(q, self.state["q_d"], strict=True)]
        longest = max(map(abs, way))
        if longest < 1e-3:
            return
        # In `glide` the peaks of velocity and acceleration are so much above the mean.
        slow = max(1.875 * abs(a) / v for a, v in zip(way, _SPEED, strict=True))
        seconds = max(_SHORTEST, slow, sqrt(5.7735 * longest / _ACCELERATION))
        cycles = round(1000.0 * seconds)
        outcome = self.move(glide(way, cycles), cycles + 20)
        # A compliant arm arrives after the end of its motion.
        is_there = outcome.is_success and self.wait_until(
            lambda state: farthest(state["q"], q) < _THERE, 0.5
        )
        if not is_there:
            away = farthest(outcome.last["q"], q) if outcome.ended else inf
            raise FciSilenceError(
                f"on the way to the pose of the check: {outcome}, {away:.3f} rad off it"
            )

    def _follow(
        self, number: int, motion: Motion, cycles: int, outcome: Outcome
    ) -> None:
        is_torque = motion.generator is MoveGenerator.NONE
        finished = f"{'torque_command' if is_torque else 'motion_generation'}_finished"
        begin = outcome.first = self.state
        deadline = time.monotonic() + _SLOWEST * cycles / 1000.0 + LONGEST_END
        while outcome.ended is None and time.monotonic() < deadline:
            state = self.state
            cycle = state["message_id"] - begin["message_id"]
            outcome.states[cycle] = state
            values = motion.stream(min(cycle, cycles), state, begin)
            if values is not None:
                head = {"message_id": state["message_id"], finished: cycle >= cycles}
                command = self.protocol.command.pack({**head, **values})
                self.network.send_datagram(bytearray(command))
                outcome.sent.append(cycle)
            answer = self.client.take_answer(number)
            if answer is None:
                # A state that was waiting had come before the last one was answered.
                missed = self.next_state()["message_id"] - state["message_id"] - 1
                self.late += missed + (self._waited > 0)
                answer = self.client.take_answer(number)
            if answer is not None:
                outcome.ended = answer.words
        # Only the state with the end of the motion may be waiting.
        self.late += max(0, self._drain()[1] - 1)


def _modes(state: State) -> tuple[int, int]:
    return state["motion_generator_mode"], state["controller_mode"]
