"""An arm behind the Franka Control Interface.

Source: libfranka@0.9.2 src/robot_impl.cpp, Robot::Impl; differs: a motion is stopped
without waiting for the end of the stop, and answers of the arm are read in a later
cycle, because the control thread waits for nothing but the next state.
"""

import contextlib
import os
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from typing_extensions import override

from station.core.errors import ArmCommandError
from station.core.franka.franka_errors import ArmError, error_names
from station.core.franka.franka_model import FrankaModel
from station.core.franka.franka_robot_state import RobotMode, RobotState
from station.core.franka.franka_services import ArmSimulation, CollisionBehavior
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.franka.arm.robot_arm import (
    MEASURED_REST,
    REST_VELOCITY,
    ControllerMode,
    MotionGeneratorMode,
    RobotArm,
)
from station.hw.franka.fci.driver.arm_link import ArmLink
from station.hw.franka.fci.driver.commanded_motion import CommandedMotion
from station.hw.franka.fci.driver.fci_client import RobotAnswer
from station.hw.franka.fci.driver.network import FciNetwork
from station.hw.franka.fci.driver.refusals import REMEDIES, refusal_of
from station.hw.franka.fci.driver.state_reader import CYCLE_TIME
from station.hw.franka.fci.wire.robot_protocol import (
    PANDA,
    Command,
    RobotProtocol,
    Status,
)
from station.memory.doubles import Doubles, Storage
from station.reports import ArmRecord


class PendingRequests:
    """Sends requests without waiting, and takes their answers. Control thread.

    Args:
        link: The link to the arm.

    Attributes:
        failure: Why the last motion, stop or recovery failed; empty if none did.
    """

    def __init__(self, link: ArmLink) -> None:
        self._link = link
        self._waiting: dict[int, Command] = {}  # by the number of the request
        self.failure = ""

    def is_waiting(self, command: Command) -> bool:
        """Return whether the answer to such a request has not come yet."""
        return command in self._waiting.values()

    def send(self, command: Command) -> None:
        """Send a request, whose answer `look` takes.

        Raises:
            ArmCommandError: The arm is lost.
        """
        self.expect(self._link.send(command), command)

    def expect(self, number: int, command: Command) -> None:
        """Wait for an answer to a request that was sent elsewhere; see `look`."""
        self._waiting[number] = command

    def look(self) -> None:
        """Take the answers that have come; called once per cycle."""
        for number in list(self._waiting):
            answer = self._link.take_answer(number)
            if answer is None:
                continue
            del self._waiting[number]
            if answer.status is not Status.SUCCESS:
                self.failure = refusal_of(answer, self._link.reader.robot_mode)

    def clear(self) -> None:
        """Stop waiting for answers: the arm is lost."""
        self._waiting.clear()


_KERNEL = Path("/sys/kernel/realtime")
_REMEDY = (
    "allow SCHED_FIFO and boot a real-time kernel, or set realtime_config: ignore (see "
    "docs/real_arm.md)"
)


def realtime_problem(thread: int, kernel: Path = _KERNEL) -> str | None:
    """Return reason and remedy if a thread cannot run in real time; None if it can.

    It must run under SCHED_FIFO on a real-time kernel.

    Args:
        thread: The thread's number in the operating system.
        kernel: File that names a real-time kernel.

    Source:
        libfranka@0.9.2 src/control_loop.cpp, ControlLoop; src/control_tools.cpp.
    """
    problem = "libfranka: unable to set realtime scheduling"
    try:
        scheduler = os.sched_getscheduler(thread)
    except (AttributeError, OSError):
        return f"{problem}; {_REMEDY}"
    if scheduler != os.SCHED_FIFO:
        return f"{problem}: SCHED_FIFO is not granted; {_REMEDY}"
    with contextlib.suppress(OSError):
        if kernel.read_text("ascii").strip() == "1":
            return None
    return f"libfranka: Running kernel does not have realtime capabilities; {_REMEDY}"


_LONGEST_START = 1000
"""Number of states within which an accepted motion must appear."""


class FciArm(RobotArm):
    """Drives an arm over a network. Its states pace the control loop: see `wait`.

    Requests that change something wait for the arm's answer, a few milliseconds, while
    no motion runs. A motion is stopped without waiting.

    An arm that is lost (no state for `UDP_TIMEOUT`, or a broken connection) is in mode
    Other from then on, and `read_once` returns at once. A recovery connects again, in
    another thread; until then the arm is in mode AutomaticErrorRecovery.

    Args:
        network: The connection to the arm.
        make_model: Makes a model of the arm.
        is_enforced: Whether a motion needs a real-time thread (`realtime_config`).
        protocol: The version that is spoken.
        find_problem: Returns why a thread is not real-time enough; None if it is.
        reopen: Opens a new connection to a lost arm; None for an arm that stays lost.

    Raises:
        FciNetworkError: The arm does not answer.
        FciProtocolError: The arm does not speak this version.
    """

    def __init__(
        self,
        network: FciNetwork,
        make_model: Callable[[], FrankaModel],
        *,
        is_enforced: bool = True,
        protocol: RobotProtocol = PANDA,
        find_problem: Callable[[int], str | None] = realtime_problem,
        reopen: Callable[[], FciNetwork] | None = None,
    ) -> None:
        self.cycle_time = CYCLE_TIME
        self.state = RobotState()
        self._make_model = make_model
        self._is_enforced, self._find_problem = is_enforced, find_problem
        self._link = ArmLink(
            network,
            protocol,
            self.state,
            on_state=self._take_state,
            on_loss=self._give_up,
            reopen=reopen,
        )
        self._reader = self._link.reader
        self._commands = CommandedMotion(
            protocol, self._reader, self._link.send_command
        )
        self._pending = PendingRequests(self._link)
        self._motion: int | None = None  # number of the request
        self._has_failed = False
        self._behavior: CollisionBehavior | None = None
        self._due = 0  # states that `wait` has taken and `read_once` has not
        self._thread = threading.get_native_id()
        self._show_mode()

    def wait(self) -> int:
        """Wait for the arm's next state, `SLICE` at most; return the elapsed cycles.

        This is the clock of a control loop: 0 when no state has come, more than 1 when
        states were lost or came while the loop did something else. `read_once` then
        returns at once, as often as cycles have elapsed.
        """
        self._look_for_return()
        self._link.receive()
        self._due = elapsed = self._link.count()
        return elapsed

    @override
    def read_once(self) -> RobotState:
        self._commands.begin_cycle()
        self._thread = threading.get_native_id()
        self._look_for_return()
        if self._due > 0:
            self._due -= 1
        else:
            self._link.receive_next()
            self._link.count()
        self._commands.is_late = self._due > 0
        self._pending.look()
        return self.state

    @override
    def refusal(
        self,
        controller_mode: ControllerMode,
        motion_generator_mode: MotionGeneratorMode,
    ) -> str | None:
        if self._link.loss is not None:
            return f"{self._link.loss}; {self.remedy()}"
        mode = self._shown_mode()
        if mode not in (RobotMode.IDLE, RobotMode.MOVE):
            return f"the arm is in mode {mode.name.lower()}; {self.remedy()}"
        is_external = controller_mode is ControllerMode.EXTERNAL_CONTROLLER
        if motion_generator_mode is MotionGeneratorMode.NONE and not is_external:
            return "the internal controller needs a motion generator"
        return self._find_problem(self._thread) if self._is_enforced else None

    @override
    def is_at_rest(self) -> bool:
        state = self.state
        return (
            not self.is_stopping()
            and all(abs(dq) < REST_VELOCITY for dq in state.doubles("dq_d"))
            and all(abs(dq) < MEASURED_REST for dq in state.doubles("dq"))
        )

    @override
    def is_stopping(self) -> bool:
        if self._pending.is_waiting(Command.STOP_MOVE):
            self._pending.look()
        return self._pending.is_waiting(Command.STOP_MOVE)

    @override
    def start_motion(
        self,
        controller_mode: ControllerMode,
        motion_generator_mode: MotionGeneratorMode,
    ) -> None:
        reason = self.refusal(controller_mode, motion_generator_mode)
        if self._motion is not None:
            reason = "a motion runs already"
        elif self.is_stopping():
            reason = "the last motion is still coming to rest"
        if reason is not None:
            raise ArmCommandError(
                f"The arm cannot start a motion: {reason}.",
                remedy="Stop the running motion, recover, or ask for other modes.",
            )
        self._pending.failure, self._has_failed = "", False
        request = self._commands.begin_motion(controller_mode, motion_generator_mode)
        try:
            self._motion = self._begin(self._link.ask(Command.MOVE, request))
        finally:
            if self._motion is None:
                self._commands.end()
        self._show_mode()

    @override
    def stop_motion(self) -> None:
        motion, self._motion = self._motion, None
        if motion is None:
            return
        self._commands.end()
        self._link.forget(motion)  # the answer to the stop tells how the motion ended
        with contextlib.suppress(ArmCommandError):  # a lost arm has no motion
            self._pending.send(Command.STOP_MOVE)
        self._show_mode()
        self._pending.look()

    @override
    def command_joint_torques(self, tau: Storage) -> None:
        self._commands.torques(tau)

    @override
    def command_joint_positions(self, q: Storage) -> None:
        self._commands.move(MotionGeneratorMode.JOINT_POSITION, q)

    @override
    def command_joint_velocities(self, dq: Storage) -> None:
        self._commands.move(MotionGeneratorMode.JOINT_VELOCITY, dq)

    @override
    def command_cartesian_pose(
        self, pose: Storage, elbow: list[float] | None = None
    ) -> None:
        self._commands.move(MotionGeneratorMode.CARTESIAN_POSITION, pose, elbow)

    @override
    def command_cartesian_velocity(
        self, twist: Storage, elbow: list[float] | None = None
    ) -> None:
        self._commands.move(MotionGeneratorMode.CARTESIAN_VELOCITY, twist, elbow)

    @override
    def load_model(self) -> FrankaModel:
        return self._make_model()

    @override
    def refresh_state(self) -> None:
        """Do nothing: the arm sends every field in every cycle."""

    @override
    def accelerometers(self) -> tuple[Doubles, Doubles] | None:
        return self._reader.accelerometers()

    @override
    def set_joint_impedance(self, stiffness: Sequence[float]) -> None:
        self._set(Command.SET_JOINT_IMPEDANCE, {"K_theta": stiffness})

    @override
    def set_cartesian_impedance(self, stiffness: Sequence[float]) -> None:
        self._set(Command.SET_CARTESIAN_IMPEDANCE, {"K_x": stiffness})

    @override
    def set_end_effector_frame(self, frame: Sequence[float]) -> None:
        self._set(Command.SET_NE_TO_EE, {"NE_T_EE": frame})

    @override
    def set_stiffness_frame(self, frame: Sequence[float]) -> None:
        self._set(Command.SET_EE_TO_K, {"EE_T_K": frame})

    @override
    def set_load(self, load: RigidBody) -> None:
        values = {
            "m_load": load.mass,
            "F_x_Cload": load.center_of_mass,
            "I_load": load.inertia,
        }
        self._set(Command.SET_LOAD, values)

    @override
    def set_collision_behavior(self, behavior: CollisionBehavior) -> None:
        self._set(Command.SET_COLLISION_BEHAVIOR, asdict(behavior))
        self._behavior = behavior

    @override
    def collision_behavior(self) -> CollisionBehavior | None:
        return self._behavior

    @override
    def is_lost(self) -> bool:
        return self._link.loss is not None

    @override
    def check_recovery(self) -> None:
        if self.state.robot_mode is RobotMode.USER_STOPPED:
            raise ArmCommandError(
                "The arm cannot recover: the user stop is pressed.",
                remedy="Release the user stop.",
            )

    @override
    def automatic_error_recovery(self) -> None:
        if self._link.loss is not None:
            told, setting = self._behavior, Command.SET_COLLISION_BEHAVIOR
            self._link.begin_return([(setting, asdict(told))] if told else [])
            self._show_mode()
            return
        self.check_recovery()
        recovery = Command.AUTOMATIC_ERROR_RECOVERY
        is_erroneous = self.state.robot_mode is RobotMode.REFLEX
        if is_erroneous and not self._pending.is_waiting(recovery):
            self._pending.failure = ""
            self._pending.send(recovery)

    @override
    def errors(self) -> list[ArmError]:
        names = error_names(self.state.current_errors)
        if not names and self._has_failed:
            names = error_names(self.state.last_motion_errors)
        cycle = self._reader.message_id
        return [ArmError(name, "", 0.0, 0.0, "", cycle) for name in names]

    @override
    def failure(self) -> str:
        return self._link.loss or self._pending.failure

    @override
    def log(self) -> list[ArmRecord]:
        return self._commands.log() if self._has_failed else []

    @override
    def remedy(self) -> str | None:
        if self._link.loss is not None:
            return f"restore the connection, then recover ({self._link.loss})"
        todo, failure = REMEDIES.get(self._shown_mode()), self._pending.failure
        return f"{todo} ({failure})" if todo and failure else todo

    @override
    def simulation(self) -> ArmSimulation | None:
        return None

    def close(self) -> None:
        """Stop a motion and hang up."""
        self.stop_motion()
        self._link.close()

    def _take_state(self) -> None:
        """Update the motion from a new state."""
        if self._motion is not None:
            self._commands.note_state()
            if not self._commands.is_shown():
                self._pending.expect(self._motion, Command.MOVE)
                self._motion, self._has_failed = None, True
                self._commands.end()
        self._show_mode()

    def _give_up(self) -> None:
        """End everything: the arm is lost."""
        self._motion = None
        self._pending.clear()
        self._has_failed = True
        self._commands.end()
        self.state.robot_mode = RobotMode.OTHER

    def _look_for_return(self) -> None:
        """Go on with a new connection if there is one."""
        if self._link.is_returning:
            if self._link.receive_return():
                self._pending.failure, self._has_failed = "", False
            self._show_mode()

    def _shown_mode(self) -> RobotMode:
        """Return the arm's mode; Idle while others move the arm."""
        if self._link.is_returning:
            return RobotMode.AUTOMATIC_ERROR_RECOVERY
        if self._link.loss is not None:
            return RobotMode.OTHER
        mode = self._reader.robot_mode
        if mode is RobotMode.MOVE and self._motion is None:
            return RobotMode.IDLE
        return mode

    def _show_mode(self) -> None:
        self.state.robot_mode = self._shown_mode()

    def _begin(self, answer: RobotAnswer) -> int:
        """Wait until the states show a motion that the arm has accepted.

        Returns:
            Number of the motion's request.

        Raises:
            ArmCommandError: The arm refuses the motion, or no state shows it in time.
        """
        if answer.status is not Status.MOTION_STARTED:
            raise self._link.refused(answer)
        for _ in range(_LONGEST_START):
            self._link.check()
            if self._commands.is_shown():
                return answer.command_id
            self._link.receive_next()
            end = self._link.take_answer(answer.command_id)
            if end is not None:
                raise self._link.refused(end)
        raise ArmCommandError("The arm does not show the motion that it has accepted.")

    def _set(self, command: Command, values: Mapping[str, Any]) -> None:
        """Change a setting, and wait for a state that shows it.

        Raises:
            ArmCommandError: A motion runs, or the arm is lost or refuses.
            InvalidCommandError: The arm refuses the value.
        """
        if self._motion is not None:
            raise ArmCommandError(
                f"{command.name} is not possible while a motion runs.",
                remedy="Stop the controllers of this arm first.",
            )
        self._link.change(command, values)
