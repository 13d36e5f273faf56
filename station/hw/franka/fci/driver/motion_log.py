"""The last cycles before an error, as libfranka's log has them."""

from collections import deque

from station.hw.franka.fci.wire.robot_protocol import RobotProtocol
from station.reports import ArmRecord

_LENGTH = 50
"""Source: libfranka@0.9.2 include/franka/robot.h, Robot, `log_size`."""


class MotionLog:
    """Keeps messages as they are; they become records when somebody asks.

    Args:
        protocol: The version of the protocol.
        command: The field of the client's commands, e.g. `q_c`.
        cycle_time: Time from one state to the next [s].
    """

    def __init__(
        self, protocol: RobotProtocol, command: str, cycle_time: float
    ) -> None:
        self._protocol = protocol
        self._command = command
        self._cycle_time = cycle_time
        self._cycles: deque[tuple[bytes, bytes]] = deque(maxlen=_LENGTH)

    def note(self, state: bytearray, command: bytearray) -> None:
        """Keep a cycle.

        Args:
            state: The arm's message.
            command: What was answered to the one before.
        """
        size = self._protocol.state.size
        self._cycles.append((bytes(state[:size]), bytes(command)))

    def records(self) -> list[ArmRecord]:
        """Return the cycles, oldest first, at most 50."""
        return [self._record(*cycle) for cycle in self._cycles]

    def _record(self, message: bytes, command: bytes) -> ArmRecord:
        state = self._protocol.state.unpack(message)
        sent = self._protocol.command.unpack(command)[self._command]
        return ArmRecord(
            state["message_id"] * self._cycle_time,
            state["q"],
            state["dq"],
            state["tau_J"],
            state["q_d"],
            state["tau_J_d"],
            sent,
        )
