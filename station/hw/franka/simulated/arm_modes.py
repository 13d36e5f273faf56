"""The modes of a simulated arm, and the transitions between the modes.

    Idle   -- a motion starts           -> Move
    Move   -- the motion is stopped     -> Idle
    Idle, Move  -- an error             -> Reflex
    Reflex      -- automatic recovery   -> AutomaticErrorRecovery
    AutomaticErrorRecovery -- at rest   -> Idle; an error: Reflex
    any         -- user stop pressed    -> UserStopped
    UserStopped -- user stop released   -> as in a recovery from Reflex
    Idle        -- guiding buttons held -> Guiding; released: Idle
    any         -- brakes closed        -> Other; opened: Idle, with an error Reflex
    any         -- simulation diverged  -> Other; reset: Idle

A recovery ends only when the arm itself is at rest, not just its desired motion:
otherwise a hand that bounces off a table would still move in Idle, and torques of a
client that began a motion then would not act before the arm has settled. An arm that
trembles in a contact never rests; its recovery ends after `LONGEST_SETTLING`. Before
that, joints beyond their limits are brought back into their range, because clients
check the start of a motion.

An arm that still touches something when it recovers goes to Idle and holds its pose.
The contact becomes an error again if it ends and another contact begins, or if its
force grows by the threshold. Any other value that is still out of its range becomes an
error again if it moves further out.

Source: libfranka@0.9.2 include/franka/robot_state.h, RobotMode; Franka Control
Interface documentation; differs: the transitions are not published in this form. People
guide a real arm back from a limit by hand; the simulated arm returns in its recovery.
"""

from collections.abc import Sequence

from typing_extensions import override

from station.core.errors import ArmCommandError, InvalidCommandError
from station.core.franka.franka_errors import ArmError
from station.core.franka.franka_robot_state import RobotMode
from station.core.franka.franka_services import ArmSimulation, FaultKind, SimulatedFault
from station.core.hardware.robot_report import ClampReport
from station.hw.franka.arm.receiver import (
    CARTESIAN,
    NO_MOTION,
    POSITIONS,
    VELOCITIES,
)
from station.hw.franka.arm.robot_arm import (
    REST_VELOCITY,
    ControllerMode,
    MotionGeneratorMode,
    SingularStartError,
)
from station.hw.franka.arm.service_limits import (
    PUSH_DISTANCE,
    ServiceLimits,
    check_vector,
    field_error,
)
from station.hw.franka.simulated.arm_parts import ArmParts
from station.hw.franka.simulated.arm_step import LONGEST_SETTLING, VIOLATION
from station.hw.mujoco.world import WORLD, World, as_push
from station.memory.doubles import put

_SUPERVISED = (
    RobotMode.IDLE,
    RobotMode.MOVE,
    RobotMode.AUTOMATIC_ERROR_RECOVERY,
)
HALTED = (
    RobotMode.REFLEX,
    RobotMode.USER_STOPPED,
    RobotMode.OTHER,
    RobotMode.GUIDING,
    RobotMode.AUTOMATIC_ERROR_RECOVERY,
)
"""Modes in which no motion can be started."""
_REMEDIES = {
    RobotMode.OTHER: "open the brakes",
    RobotMode.USER_STOPPED: "release the user stop",
    RobotMode.REFLEX: "remove the cause, then recover",
    RobotMode.GUIDING: "let go of the guiding buttons",
    RobotMode.AUTOMATIC_ERROR_RECOVERY: "wait until the arm is at rest",
}
_CODES = {
    MotionGeneratorMode.NONE: NO_MOTION,
    MotionGeneratorMode.JOINT_POSITION: POSITIONS,
    MotionGeneratorMode.JOINT_VELOCITY: VELOCITIES,
    MotionGeneratorMode.CARTESIAN_POSITION: CARTESIAN,
    MotionGeneratorMode.CARTESIAN_VELOCITY: CARTESIAN,
}
_INSIDE = 0.005
"""Distance inside its limit to which a recovery brings a joint [rad]."""
_RETURN_VELOCITY = 0.1
"""Largest speed of this return [rad/s]."""
_RETURN_TIME = 0.05
"""Time constant with which the joint comes to rest [s]."""
_RETURNED = 1e-4
"""Distance from its goal at which the joint counts as returned [rad]."""
INTERNAL_CONTROLLERS = (
    ControllerMode.JOINT_IMPEDANCE,
    ControllerMode.CARTESIAN_IMPEDANCE,
)
"""Controllers that follow the desired motion."""


class ArmModes(ArmSimulation):
    """Keeps the mode of one arm; has the buttons, pushes and faults that change it.

    Control thread only.

    Args:
        world: The world of the arm.
        parts: The parts of the arm; this class writes `robot_mode` and the success rate
            of the state.
        service_limits: The largest pushes.

    Attributes:
        controller: The controller mode of the running motion; None without a motion.
        generator: The motion generator of the running motion.
    """

    def __init__(
        self, world: World, parts: ArmParts, service_limits: ServiceLimits
    ) -> None:
        self._world = world
        self._state = parts.state
        self._motion = parts.motion
        self._memory = parts.memory
        self._positions = parts.memory.positions
        self._step, self._check = parts.step, parts.check
        self._motors = parts.motors
        self._frames = parts.frames
        self._limits, self._service_limits = parts.limits, service_limits
        self._faults, self._joint_names = parts.faults, parts.joint_names
        self._supervisor = parts.supervisor
        self._contact = parts.contact
        self.controller: ControllerMode | None = None
        self.generator = MotionGeneratorMode.NONE
        self._settling = 0
        # Goal of each joint that was beyond a limit; None until the arm has come to
        # rest in a recovery.
        self._returns: dict[int, float] | None = None

    def remedy(self) -> str | None:
        """Return the step needed before the arm can move; None if it can move."""
        if self._world.diverged_because:
            return "reset the simulation"
        return _REMEDIES.get(self._state.robot_mode)

    def refusal(
        self, controller: ControllerMode, generator: MotionGeneratorMode
    ) -> str | None:
        """Return the reason why an arm at rest cannot start a motion now.

        None if the motion could start; see `RobotArm.refusal`.
        """
        refused = self._refusal_of_mode(controller, generator)
        return self._singular_start(generator) if refused is None else refused

    def _refusal_of_mode(
        self, controller: ControllerMode, generator: MotionGeneratorMode
    ) -> str | None:
        mode = self._state.robot_mode
        if self._world.diverged_because:
            return f"{self._world.diverged_because}; {self.remedy()}"
        if mode in HALTED:
            causes = [error.description for error in self._supervisor.errors]
            because = f" ({'; '.join(causes)})" if causes else ""
            return f"the arm is in mode {mode.name.lower()}{because}; {self.remedy()}"
        is_external = controller is ControllerMode.EXTERNAL_CONTROLLER
        if generator is MotionGeneratorMode.NONE and not is_external:
            return "the internal controller needs a motion generator"
        return None

    def begin_motion(
        self, controller: ControllerMode, generator: MotionGeneratorMode
    ) -> None:
        """Go from Idle to Move; see `RobotArm.start_motion`.

        Raises:
            ArmCommandError: A motion runs already, or `refusal` has a reason.
        """
        kind: type[ArmCommandError] = ArmCommandError
        if self._state.robot_mode is RobotMode.MOVE:
            reason: str | None = "a motion runs already"
        else:
            reason = self._refusal_of_mode(controller, generator)
        if reason is None:
            kind, reason = SingularStartError, self._singular_start(generator)
        if reason is not None:
            raise kind(
                f"The arm cannot start a motion: {reason}.",
                remedy="Stop the running motion, recover, or ask for other modes.",
            )
        self._set_modes(controller, generator)
        self.expect_command()
        self._supervisor.begin_motion()
        self._frames.is_cartesian = _CODES[generator] == CARTESIAN
        if controller is ControllerMode.CARTESIAN_IMPEDANCE:
            self._motors.engage_cartesian_impedance()
        self._state.robot_mode = RobotMode.MOVE
        self._state.control_command_success_rate = 1.0

    def _singular_start(self, generator: MotionGeneratorMode) -> str | None:
        if _CODES[generator] != CARTESIAN:
            return None
        return self._supervisor.singular_start()

    def expect_command(self) -> None:
        """Wait for the first command of the motion, if one runs."""
        self._step.begin_motion(_CODES[self.generator])

    def is_at_rest(self) -> bool:
        """Return whether the arm and its desired motion both stand still."""
        return self._motion.is_at_rest() and self.is_still()

    def end_motion(self, mode: RobotMode) -> None:
        """Go to a mode without a motion, and hold the pose.

        Args:
            mode: The mode to go to.
        """
        state = self._state
        was_moving = state.robot_mode is RobotMode.MOVE
        state.robot_mode = mode
        if was_moving:
            self._supervisor.end_motion()
        # Torques, or the motion before an error, have moved the arm away from q_d.
        # Without this reset the arm would jump back to q_d.
        if self._motors.torques_act or mode is not RobotMode.IDLE:
            self._motion.seed(self._positions, state.dtheta)
        self._motors.engage_joint_impedance()
        self._set_modes(None, MotionGeneratorMode.NONE)
        self._frames.is_cartesian = False
        state.tau_J_d = [0.0] * len(state.tau_J_d)
        state.control_command_success_rate = 0.0

    def _set_modes(
        self, controller: ControllerMode | None, generator: MotionGeneratorMode
    ) -> None:
        self.controller = controller
        self.generator = generator
        self._step.wants_torques = controller is ControllerMode.EXTERNAL_CONTROLLER
        self._step.is_following = controller in INTERNAL_CONTROLLERS

    def raise_errors(self, errors: Sequence[ArmError]) -> None:
        """Go to Reflex: end the motion and hold the present pose.

        Args:
            errors: The errors that have occurred, at least one.
        """
        self._supervisor.set_errors(errors, self._world.step_count)
        self.end_motion(RobotMode.REFLEX)

    def react_to_observer(self, found: int) -> None:
        """Carry out the requests of the observer, e.g. the loss of a command.

        Args:
            found: Result of `FrictionAndObserver.sense`.
        """
        # Only a motion has commands that can be lost.
        if self._contact.react_to(found) and self._state.robot_mode is RobotMode.MOVE:
            self._faults.drop()
            self._step.has_faults = True

    def supervise(self, found: int) -> None:
        """Update the contacts, and find errors in the readings.

        Args:
            found: Result of `ArmStep.read_joints`.
        """
        has_diverged = self._world.diverged_because is not None
        # Checked first, because the readings of a diverged world mean nothing.
        if has_diverged and self._state.robot_mode is not RobotMode.OTHER:
            self.end_motion(RobotMode.OTHER)
        errors = self._contact.update()
        mode = self._state.robot_mode
        if mode in _SUPERVISED:
            errors = errors + self._supervisor.examine(
                is_quiet=not found & VIOLATION,
                is_following=self._step.is_following,
                is_recovering=mode is RobotMode.AUTOMATIC_ERROR_RECOVERY,
            )
            if errors:
                self.raise_errors(errors)

    def check_recovery(self) -> None:
        """Refuse if the arm cannot recover itself now.

        Raises:
            ArmCommandError: The world has diverged, the brakes are closed, or the user
                stop is pressed.
        """
        if self._world.diverged_because:
            raise ArmCommandError(
                f"The arm cannot recover: {self._world.diverged_because}.",
                remedy="Reset the simulation.",
            )
        if self._state.robot_mode is RobotMode.OTHER:
            raise ArmCommandError(
                "The arm cannot recover: its brakes are closed.",
                remedy="Open the brakes.",
            )
        if self._state.robot_mode is RobotMode.USER_STOPPED:
            raise ArmCommandError(
                "The arm cannot recover: the user stop is pressed.",
                remedy="Release the user stop.",
            )

    def recover(self) -> None:
        """Forget the errors, and go to Idle as soon as the arm is at rest."""
        self._supervisor.recover()
        self._contact.recover()
        self._settling = 0
        self._returns = None
        self._state.robot_mode = RobotMode.AUTOMATIC_ERROR_RECOVERY
        self.finish_recovery()

    def finish_recovery(self) -> None:
        """Go from AutomaticErrorRecovery to Idle if the arm is at rest in its range."""
        if not self._motion.is_at_rest():
            return
        # Found only at rest, because a braking joint may still pass its limit.
        if self._returns is None:
            self._returns = self._find_returns()
        if self._returns:
            return
        self._settling += 1
        if self.is_still() or self._settling > LONGEST_SETTLING:
            self._state.robot_mode = RobotMode.IDLE

    def advance_recovery(self) -> None:
        """Bring joints back into their range, come to rest, and end the recovery."""
        if not self._advance_return():
            self._motion.hold()
        self.finish_recovery()

    def _advance_return(self) -> bool:
        """Move joints beyond their limits back; return False if none moves."""
        if not self._returns:
            return False
        memory, period = self._memory, self._world.timestep
        put(memory.target, [0.0] * memory.size)
        for joint, goal in list(self._returns.items()):
            way, velocity = goal - memory.q_d[joint], memory.dq_d[joint]
            if abs(way) < _RETURNED:
                del self._returns[joint]
                continue
            wanted = max(-_RETURN_VELOCITY, min(way / _RETURN_TIME, _RETURN_VELOCITY))
            most = _RETURN_VELOCITY * period / _RETURN_TIME
            change = max(-most, min(wanted - velocity, most))
            memory.target[joint] = velocity + change
        self._motion.follow_velocities()
        return True

    def _find_returns(self) -> dict[int, float]:
        """Return the goal of each joint beyond a limit, inside its range [rad]."""
        found: dict[int, float] = {}
        memory, limits = self._memory, self._limits
        ranges = zip(limits.lower, limits.upper, strict=True)
        for joint, (lower, upper) in enumerate(ranges):
            both = memory.q_d[joint], memory.positions[joint]
            if max(both) > upper:
                found[joint] = upper - _INSIDE
            elif min(both) < lower:
                found[joint] = lower + _INSIDE
        return found

    def is_still(self) -> bool:
        """Return whether no joint moves; the desired motion does not matter."""
        return max(map(abs, self._state.dtheta)) < REST_VELOCITY

    @override
    def set_user_stop(self, *, pressed: bool) -> None:
        """Press or release the user stop; releasing it clears the errors."""
        mode = self._state.robot_mode
        # A diverged arm stays in Other: otherwise releasing the stop would make it
        # Idle.
        if pressed and mode not in (RobotMode.OTHER, RobotMode.USER_STOPPED):
            self.end_motion(RobotMode.USER_STOPPED)
        elif not pressed and mode is RobotMode.USER_STOPPED:
            self.recover()

    @override
    def set_guiding(self, *, pressed: bool) -> None:
        """Press or release the guiding buttons.

        Raises:
            ArmCommandError: The buttons are to be pressed and the arm is not idle.
        """
        mode = self._state.robot_mode
        if pressed and mode is RobotMode.IDLE:
            self._state.robot_mode = RobotMode.GUIDING
            self._motors.engage_torques()
        elif pressed and mode is not RobotMode.GUIDING:
            remedy = self.remedy() or "stop the controllers of this arm first"
            raise ArmCommandError(
                f"The arm cannot be guided: it is in mode {mode.name.lower()}.",
                remedy=f"{remedy[0].upper()}{remedy[1:]}.",
            )
        elif not pressed and mode is RobotMode.GUIDING:
            self.end_motion(RobotMode.IDLE)

    @override
    def set_brakes(self, *, closed: bool) -> None:
        """Close or open the brakes; the arm also holds its pose without them."""
        mode = self._state.robot_mode
        if closed and mode is not RobotMode.OTHER:
            self.end_motion(RobotMode.OTHER)
        has_diverged = self._world.diverged_because is not None
        if not closed and mode is RobotMode.OTHER and not has_diverged:
            has_errors = bool(self._supervisor.errors)
            self._state.robot_mode = RobotMode.REFLEX if has_errors else RobotMode.IDLE

    @override
    def set_state_precision(self, *, is_single: bool) -> None:
        """Allow what rounding of the state adds to commands at their limits."""
        self._check.set_precision(is_single=is_single)

    @override
    def apply_force(
        self,
        link: str,
        force: Sequence[float],
        torque: Sequence[float],
        duration: float,
        *,
        frame: str = WORLD,
        point: Sequence[float] | None = None,
    ) -> None:
        self._check_force(force)
        largest = self._service_limits.push_torque
        check_vector(
            torque, largest, field="torque", what="torque of a push", unit="Nm"
        )
        if point is not None:
            check_vector(
                point, PUSH_DISTANCE, field="point", what="point of a push", unit="m"
            )
        self._check_duration(duration)
        push = as_push(link, force, torque, frame=frame, point=point)
        self._world.push(push, max(1, round(duration / self._world.timestep)))

    @override
    def inject(self, fault: SimulatedFault) -> None:
        if fault.kind is FaultKind.COLLISION:
            self._check_force(fault.force)
        self._faults.inject(fault)
        self._step.has_faults = self._faults.act

    @override
    def faults(self) -> list[SimulatedFault]:
        return self._faults.active()

    @override
    def clear_faults(self) -> None:
        self._faults.clear()
        self._step.has_faults = False

    def _check_force(self, force: Sequence[float]) -> None:
        largest = self._service_limits.push_force
        check_vector(force, largest, field="force", what="force of a push", unit="N")

    def _check_duration(self, duration: float) -> None:
        longest = self._service_limits.push_duration
        if not 0.0 < duration <= longest:
            allowed = f"above 0 s and at most {longest:g} s"
            raise InvalidCommandError(
                f"A push of {duration} s is not possible; allowed is {allowed}.",
                remedy="Choose a duration in this range.",
                details=field_error("duration", f"must be {allowed}", duration),
            )

    @override
    def clamps(self) -> list[ClampReport]:
        return self._world.brakes.clamps(self._joint_names)

    def not_commandable(self, what: str) -> ArmCommandError:
        """Return the refusal of commands that do not fit the present motion.

        Args:
            what: Name of the commands.
        """
        controller = self.controller.value if self.controller else "none"
        return ArmCommandError(
            f"The arm takes no {what}: it is in mode {self._state.robot_mode.name}, "
            f"controller {controller}, motion generator {self.generator.value}.",
            remedy="Start a motion with the fitting modes first.",
        )

    def refuse_while_moving(self, what: str) -> None:
        """Refuse to change a setting during a motion.

        Args:
            what: Name of the setting.

        Raises:
            ArmCommandError: A motion runs.
        """
        if self._state.robot_mode is RobotMode.MOVE:
            raise ArmCommandError(
                f"The {what} cannot be changed while a motion runs.",
                remedy="Stop the controllers of this arm first.",
            )
