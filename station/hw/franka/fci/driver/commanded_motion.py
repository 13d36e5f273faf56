"""The motion that the station commands: its modes, its commands, and its log.

Source: libfranka@0.9.2 src/robot_impl.cpp, Robot::Impl::sendRobotCommand, update.
"""

from collections import deque
from collections.abc import Callable, Sequence
from math import isfinite, pi
from typing import Any

from station.core.errors import ArmCommandError, InvalidCommandError
from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.arm.transform_check import transform_problem
from station.hw.franka.fci.driver.state_reader import CYCLE_TIME, StateReader
from station.hw.franka.fci.wire.robot_protocol import (
    MoveController,
    MoveGenerator,
    RobotProtocol,
)
from station.memory.doubles import Storage
from station.reports import ArmRecord

_LENGTH = 50
"""Number of cycles kept. Source: libfranka@0.9.2 include/franka/robot.h, `log_size`."""


_DEVIATIONS = (10.0, 3.12, 2.0 * pi)
"""Largest deviations from a motion [m, rad, rad]. Source: libfranka@0.9.2
src/control_loop.h, kDefaultDeviation."""
_FIELDS = {
    MotionGeneratorMode.NONE: "tau_J_d",
    MotionGeneratorMode.JOINT_POSITION: "q_c",
    MotionGeneratorMode.JOINT_VELOCITY: "dq_c",
    MotionGeneratorMode.CARTESIAN_POSITION: "O_T_EE_c",
    MotionGeneratorMode.CARTESIAN_VELOCITY: "O_dP_EE_c",
}
_WORDS = {
    "tau_J_d": "joint torques",
    "q_c": "joint commands",
    "dq_c": "joint commands",
    "O_T_EE_c": "a Cartesian command",
    "O_dP_EE_c": "a Cartesian command",
}
_TORQUES, _MOTION = 1, 2


class CommandedMotion:
    """Sends the commands of one motion after the other. Control thread.

    A command leaves as soon as everything that its motion needs is there: torques, the
    motion, or both. It answers the newest state; half of a command is never sent.

    Args:
        protocol: The version that is spoken.
        reader: The newest state.
        send: Sends a command.

    Attributes:
        is_late: Whether the present cycle has passed, so that nothing is sent for it.
    """

    def __init__(
        self,
        protocol: RobotProtocol,
        reader: StateReader,
        send: Callable[[bytearray], None],
    ) -> None:
        self._protocol, self._reader, self._send = protocol, reader, send
        self._layout = protocol.command
        self._message = bytearray(self._layout.size)
        self._controller: ControllerMode | None = None
        self._generator = MotionGeneratorMode.NONE
        self._modes = (0, 0)  # as on the wire
        self._needed = self._given = 0
        self._logged = "tau_J_d"  # the field of the commands that the log shows
        # State and command of the last cycles, in the form in which they came.
        self._cycles: deque[tuple[bytes, bytes]] = deque(maxlen=_LENGTH)
        self.is_late = False

    def begin_motion(
        self, controller: ControllerMode, generator: MotionGeneratorMode
    ) -> dict[str, Any]:
        """Prepare a motion; return the request for it.

        Args:
            controller: Controller that makes the torques.
            generator: Kind of the commanded motion.
        """
        kind, motion = MoveController[controller.name], MoveGenerator[generator.name]
        # A version without a generator for torques alone gets a motion with joint
        # velocities that are zero, as from libfranka.
        if motion not in self._protocol.generators:
            motion = MoveGenerator.JOINT_VELOCITY
        self._controller, self._generator = controller, generator
        self._modes = (1 + motion, kind)
        needs_torques = controller is ControllerMode.EXTERNAL_CONTROLLER
        moves = generator is not MotionGeneratorMode.NONE
        self._needed, self._given = _TORQUES * needs_torques + _MOTION * moves, 0
        self._message[:] = bytes(len(self._message))
        self._logged = _FIELDS[generator]
        self._cycles = deque(maxlen=_LENGTH)
        return {
            "controller_mode": kind,
            "motion_generator_mode": motion,
            "maximum_path_deviation": _DEVIATIONS,
            "maximum_goal_pose_deviation": _DEVIATIONS,
        }

    def end(self) -> None:
        """Refuse all further commands."""
        self._controller, self._generator = None, MotionGeneratorMode.NONE

    def begin_cycle(self) -> None:
        """Forget an incomplete command of the last cycle."""
        self._given = 0

    def note_state(self) -> None:
        """Keep the newest state for the log, with the command to the one before."""
        state = bytes(self._reader.message[: self._protocol.state.size])
        self._cycles.append((state, bytes(self._message)))

    def log(self) -> list[ArmRecord]:
        """Return the last cycles of the motion, oldest first, at most 50."""
        return [self._record(*cycle) for cycle in self._cycles]

    def is_shown(self) -> bool:
        """Return whether the robot's newest state reports that this motion runs."""
        reader = self._reader
        return reader.robot_mode is RobotMode.MOVE and reader.modes == self._modes

    def torques(self, tau: Storage) -> None:
        """Command torques.

        Raises:
            InvalidCommandError: `tau` are not 7 finite numbers.
            ArmCommandError: The motion has no torques.
        """
        if self._controller is not ControllerMode.EXTERNAL_CONTROLLER:
            raise self._not_commandable("joint torques")
        self._write("tau_J_d", tau)
        self._give(_TORQUES)

    def move(
        self,
        generator: MotionGeneratorMode,
        values: Storage,
        elbow: Sequence[float] | None = None,
    ) -> None:
        """Command joint positions or velocities, a pose or a twist.

        Args:
            generator: Kind of the command.
            values: The numbers.
            elbow: Position of joint 3 [rad] and sign of joint 4, or None.

        Raises:
            InvalidCommandError: The numbers are not such a command, or the elbow is
                impossible.
            ArmCommandError: The motion is of another kind.
        """
        if self._generator is not generator:
            raise self._not_commandable(generator.value.replace("_", " "))
        if elbow is not None:
            _check_elbow(elbow)
        self._write(_FIELDS[generator], values)
        if elbow is not None:
            self._layout.write(self._message, "elbow_c", *elbow)
        self._layout.write(self._message, "valid_elbow", elbow is not None)
        self._give(_MOTION)

    def _record(self, message: bytes, command: bytes) -> ArmRecord:
        state = self._protocol.state.unpack(message)
        sent = self._layout.unpack(command)[self._logged]
        told = {name: state[name] for name in ("q", "dq", "tau_J", "q_d", "tau_J_d")}
        time = state["message_id"] * CYCLE_TIME
        return ArmRecord(time=time, command=sent, **told)

    def _write(self, field: str, values: Storage) -> None:
        """Write a part of the cycle's command into the message.

        Raises:
            InvalidCommandError: The values are not as many finite numbers as the field
                has, or a pose is no transform.
        """
        size = self._layout.counts[field]
        if len(values) != size or not all(map(isfinite, values)):
            raise InvalidCommandError(
                f"{[*values]} are not {_WORDS[field]}: {size} finite numbers are "
                "needed."
            )
        problem = transform_problem(values) if field == "O_T_EE_c" else None
        if problem is not None:
            raise InvalidCommandError(
                f"The commanded pose {[*values]} is no transform: {problem}."
            )
        self._layout.write(self._message, field, *values)

    def _give(self, part: int) -> None:
        """Note a part of the cycle's command; send the command when it is complete."""
        self._given |= part
        if self._given == self._needed and not self.is_late:
            number = self._reader.message_id
            self._layout.write(self._message, "message_id", number)
            self._send(self._message)

    def _not_commandable(self, what: str) -> ArmCommandError:
        controller = self._controller.value if self._controller else "none"
        return ArmCommandError(
            f"The arm takes no {what}: it is in mode {self._reader.robot_mode.name}, "
            f"controller {controller}, motion generator {self._generator.value}.",
            remedy="Start a motion with the fitting modes first.",
        )


def _check_elbow(elbow: Sequence[float]) -> None:
    if len(elbow) != 2 or not isfinite(elbow[0]) or abs(elbow[1]) != 1.0:
        raise InvalidCommandError(
            f"Elbow {[*elbow]} is impossible: give the position of joint 3 and the "
            "sign of joint 4, +1 or -1."
        )
