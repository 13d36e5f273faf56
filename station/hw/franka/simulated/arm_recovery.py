"""The modes of a simulated arm in which no client moves it, and the ways out of them.

    Idle, Move  -- an error              -> Reflex
    Reflex      -- automatic recovery    -> AutomaticErrorRecovery
    AutomaticErrorRecovery -- at rest    -> Idle; an error: Reflex
    any         -- user stop pressed     -> UserStopped
    UserStopped -- user stop released    -> as from Reflex by a recovery
    Idle        -- guiding buttons held  -> Guiding; let go: Idle
    any         -- simulation diverged   -> Other; reset: Idle

An arm that still touches something when it recovers goes to Idle and holds; the touch
is a collision again when it has ended, or when it gets harder by as much as the
threshold. What else is still out of its range is an error again when it gets worse.

Source: libfranka@0.9.2 include/franka/robot_state.h, RobotMode; Franka Control
Interface documentation; differs: the edges are not published as such. A real arm is
guided back from a limit; this one can be commanded back as well.
"""

from abc import abstractmethod

from typing_extensions import override

from station.core.errors import ArmCommandError
from station.core.franka.franka_errors import ArmError
from station.core.franka.franka_robot_state import RobotMode
from station.core.franka.franka_services import ArmRecord
from station.hw.franka.simulated.arm_settings import ArmSettings
from station.hw.franka.simulated.arm_supervisor import ArmSupervisor
from station.hw.franka.simulated.desired_motion import DesiredMotion
from station.hw.mujoco.world import World

HALTED = (
    RobotMode.REFLEX,
    RobotMode.USER_STOPPED,
    RobotMode.OTHER,
    RobotMode.GUIDING,
    RobotMode.AUTOMATIC_ERROR_RECOVERY,
)
"""Modes in which no motion can be started."""


class ArmRecovery(ArmSettings):
    """Recovery, user stop and guiding of a simulated arm. Control thread only.

    Attributes:
        supervisor: The errors and where they came from.
    """

    supervisor: ArmSupervisor
    _world: World
    _motion: DesiredMotion

    @override
    def check_recovery(self) -> None:
        if self._world.diverged_because:
            raise ArmCommandError(
                f"cannot recover: {self._world.diverged_because}",
                remedy=self.remedy() or "",
            )
        if self.state.robot_mode is RobotMode.USER_STOPPED:
            raise ArmCommandError(
                "cannot recover: the user stop is pressed", remedy=self.remedy() or ""
            )

    @override
    def automatic_error_recovery(self) -> None:
        self.check_recovery()
        if self.state.robot_mode is RobotMode.REFLEX:
            self._recover()

    @override
    def errors(self) -> list[ArmError]:
        return list(self.supervisor.errors or self.supervisor.last_motion_errors)

    @override
    def log(self) -> list[ArmRecord]:
        return list(self.supervisor.log)

    @override
    def remedy(self) -> str | None:
        if self._world.diverged_because:
            return "reset the simulation"
        match self.state.robot_mode:
            case RobotMode.USER_STOPPED:
                return "release the user stop"
            case RobotMode.REFLEX:
                return "remove the cause, then recover"
            case RobotMode.GUIDING:
                return "let go of the guiding buttons"
            case RobotMode.AUTOMATIC_ERROR_RECOVERY:
                return "wait until the arm is at rest"
            case _:
                return None

    def set_user_stop(self, *, pressed: bool) -> None:
        """Press or release the user stop; releasing it clears the errors."""
        mode = self.state.robot_mode
        if pressed and mode not in (RobotMode.OTHER, RobotMode.USER_STOPPED):
            self._end_motion(RobotMode.USER_STOPPED)
        elif not pressed and mode is RobotMode.USER_STOPPED:
            self._recover()

    def set_guiding(self, *, pressed: bool) -> None:
        """Hold or let go of the guiding buttons; held, the arm gives way.

        Raises:
            ArmCommandError: The arm is not idle.
        """
        mode = self.state.robot_mode
        if pressed and mode is RobotMode.IDLE:
            self.state.robot_mode = RobotMode.GUIDING
            self.motors.engage_torques()
        elif pressed and mode is not RobotMode.GUIDING:
            raise ArmCommandError(
                f"the arm cannot be guided: it is in mode {mode.name.lower()}",
                remedy=self.remedy() or "stop the controllers of this arm first",
            )
        elif not pressed and mode is RobotMode.GUIDING:
            self._end_motion(RobotMode.IDLE)

    def _recover(self) -> None:
        """Forget the errors and go to Idle as soon as the arm is at rest."""
        self.supervisor.recover()
        self.contact.recover()
        self.state.robot_mode = RobotMode.AUTOMATIC_ERROR_RECOVERY
        self._finish_recovery()

    def _finish_recovery(self) -> None:
        if self._motion.is_at_rest:
            self.state.robot_mode = RobotMode.IDLE

    @abstractmethod
    def _end_motion(self, mode: RobotMode) -> None:
        """Go to a mode without a motion and hold."""
