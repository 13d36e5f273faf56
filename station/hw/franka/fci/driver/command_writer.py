"""Put the commands of a cycle into the message that answers the arm's state."""

import struct
from collections.abc import Sequence
from math import isfinite

from station.core.errors import InvalidCommandError
from station.hw.franka.arm.transform_check import transform_problem
from station.hw.franka.fci.wire.robot_protocol import RobotProtocol
from station.memory.doubles import Storage, put

_ID = struct.Struct("<Q")
_FIRST_DOUBLE, _BEHIND_DOUBLES = "q_c", "valid_elbow"


class CommandWriter:
    """Keeps one message; every command replaces a part of it. Control thread.

    Args:
        protocol: The version of the protocol.

    Attributes:
        message: The message.
    """

    def __init__(self, protocol: RobotProtocol) -> None:
        layout = protocol.command
        self.message = bytearray(layout.size)
        self._places = places = layout.offsets
        first, behind = places[_FIRST_DOUBLE], places[_BEHIND_DOUBLES]
        numbers = memoryview(self.message)[first:behind].cast("d")
        self._parts = {
            name: numbers[(places[name] - first) // 8 :][: layout.counts[name]]
            for name in ("q_c", "dq_c", "O_T_EE_c", "O_dP_EE_c", "elbow_c")
        }
        self._torques = struct.Struct(f"<{layout.counts['tau_J_d']}d")

    def clear(self) -> None:
        """Forget the commands of an earlier motion."""
        self.message[:] = bytes(len(self.message))

    def number(self, message_id: int) -> None:
        """Say which state the message answers."""
        _ID.pack_into(self.message, 0, message_id)

    def joints(self, name: str, values: Storage) -> None:
        """Put joint positions (`q_c`) or velocities (`dq_c`) in, shape (7,).

        Raises:
            InvalidCommandError: Not 7 finite numbers.
        """
        _check(values, 7, "joint commands")
        put(self._parts[name], values)

    def torques(self, values: Storage) -> None:
        """Put torques in, shape (7,).

        Raises:
            InvalidCommandError: Not 7 finite numbers.
        """
        _check(values, 7, "joint torques")
        self._torques.pack_into(self.message, self._places["tau_J_d"], *values)

    def cartesian(
        self, name: str, values: Storage, elbow: Sequence[float] | None
    ) -> None:
        """Put a pose (`O_T_EE_c`) or a twist (`O_dP_EE_c`) in.

        Args:
            name: Which of them.
            values: The numbers.
            elbow: Position of joint 3 [rad] and sign of joint 4, or None.

        Raises:
            InvalidCommandError: The numbers are no pose or twist, or the elbow is
                impossible.
        """
        part = self._parts[name]
        _check(values, len(part), "a Cartesian command")
        problem = transform_problem(values) if name == "O_T_EE_c" else None
        if problem is not None:
            raise InvalidCommandError(
                f"The commanded pose {[*values]} is no transform: {problem}."
            )
        if elbow is not None:
            _check_elbow(elbow)
            put(self._parts["elbow_c"], elbow)
        put(part, values)
        self.message[self._places["valid_elbow"]] = elbow is not None


def _check(values: Storage, size: int, what: str) -> None:
    if len(values) != size or not all(map(isfinite, values)):
        raise InvalidCommandError(
            f"{[*values]} are not {what}: {size} finite numbers are needed."
        )


def _check_elbow(elbow: Sequence[float]) -> None:
    if len(elbow) != 2 or not isfinite(elbow[0]) or abs(elbow[1]) != 1.0:
        raise InvalidCommandError(
            f"Elbow {[*elbow]} is impossible: give the position of joint 3 and the "
            "sign of joint 4, +1 or -1."
        )
