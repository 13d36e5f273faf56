"""Begin motions of the arm: joint motions at once, all others from rest.

Source: franka_ros@c11f000 franka_hw/src/franka_hw.cpp, FrankaHW::prepareSwitch, which
waits for the end of the running motion; differs: a joint motion begins at once, also
while the arm moves, because its limits are those of the joints. The limits of a
Cartesian motion do not bound the joints, so the joints could exceed theirs if such a
motion began while they move. Torques of a client act only when the arm is at rest, so
that the torque controller starts from the pose that the arm holds, without braking
torques.
"""

from station.core.errors import ArmCommandError
from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.arm.control_mode import ControlMode
from station.hw.franka.arm.robot_arm import (
    MEASURED_REST,
    REST_VELOCITY,
    ControllerMode,
    RobotArm,
)
from station.hw.franka.commands.command_sender import CommandSender
from station.hw.franka.commands.rate_limiter import CommandSettings

LONGEST_WAIT = 500
"""Number of arm cycles after which a motion begins although the arm still trembles."""
_CARTESIAN = ControlMode.CARTESIAN_POSE | ControlMode.CARTESIAN_VELOCITY
_FROM_REST = _CARTESIAN | ControlMode.JOINT_TORQUE


class MotionStart:
    """Ends the arm's motion and begins the next one. Control thread only.

    Args:
        arm: The arm.
        sender: Sends the commands, and seeds them at the start of a motion.

    Attributes:
        mode: The kinds of command that controllers give since the last switch.
        has_failed: Whether the arm refused the last motion.
        impedance: The controller of the arm whose impedance was set last.
    """

    def __init__(self, arm: RobotArm, sender: CommandSender) -> None:
        self._arm = arm
        self._sender = sender
        self._settings: CommandSettings | None = None
        self._waited = 0
        self.mode = ControlMode.NONE
        self.has_failed = False
        self.impedance = ControllerMode.JOINT_IMPEDANCE

    def refusal(
        self, mode: ControlMode, settings: CommandSettings, kept: ControlMode
    ) -> str | None:
        """Return the reason why another mode is refused now; None if it is possible.

        Args:
            mode: The kinds of command after the change.
            settings: Settings of filter, limits and controller.
            kept: The kinds of command that running controllers continue to give.
        """
        arm, motion = self._arm, kept & ~ControlMode.JOINT_TORQUE
        reason = arm.refusal(*settings.arm_modes(mode, self.impedance))
        state = arm.state
        # This is a rule of the station. The arm has no error for it: it ends the motion
        # that runs, and checks only the first command of the next motion.
        moves = any(abs(dq) > REST_VELOCITY for dq in state.dq_d) or any(
            abs(dq) > MEASURED_REST for dq in state.dq
        )
        if reason is None and motion and mode & _FROM_REST and moves:
            reason = (
                f"that would interrupt its motion by {motion.describe()}; let it come "
                "to rest, or stop its controllers and start all of them together"
            )
        return reason

    def enter(
        self, mode: ControlMode, settings: CommandSettings, started: ControlMode
    ) -> None:
        """Change the arm to another mode; the first commands continue the motion.

        Args:
            mode: The kinds of command after the change.
            settings: Settings of filter, limits and controller.
            started: The kinds of command that newly started controllers give.
        """
        arm, sender = self._arm, self._sender
        # A Cartesian controller that starts begins a new motion even in the same mode,
        # because its first pose is compared with the present one.
        if mode != self.mode or started & _CARTESIAN:
            arm.stop_motion()
        self.mode, self._settings = mode, settings
        sender.is_active = bool(mode)
        sender.begin_motion(mode, settings)
        sender.is_waiting = bool(mode) and arm.state.robot_mode is not RobotMode.MOVE
        self._waited = 0
        self.advance(0)

    def advance(self, cycles: int) -> None:
        """Begin the motion if the arm is ready for it.

        Args:
            cycles: Cycles of the arm since the last call.
        """
        settings = self._settings
        arm, sender = self._arm, self._sender
        if not sender.is_waiting or settings is None:
            return
        modes = settings.arm_modes(self.mode, self.impedance)
        if arm.refusal(*modes) is not None:
            sender.is_waiting, self.has_failed = False, True
            return
        self._waited += cycles
        is_ready = arm.is_at_rest() or not self.mode & _FROM_REST
        if (is_ready and not arm.is_stopping()) or self._waited > LONGEST_WAIT:
            sender.is_waiting = False
            # Seeded again, because the arm has come to rest at another place than where
            # it was at the switch.
            sender.begin_motion(self.mode, settings)
            try:
                arm.start_motion(*modes)
            except ArmCommandError as error:
                # An arm behind a network may refuse a motion that seemed possible.
                self.has_failed = True
                sender.refusal = error.message.rstrip(".")
