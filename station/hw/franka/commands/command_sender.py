"""Send the commands of controllers to an arm, limited and filtered."""

from typing import TYPE_CHECKING, Protocol

from station.core.errors import InvalidCommandError
from station.core.numerics.command_rates import CommandRates
from station.hw.franka.arm import receiver as codes
from station.memory.doubles import Doubles

if TYPE_CHECKING:
    from collections.abc import Callable

    from station.core.geometry.guard import Guard
    from station.core.hardware.limits.limited_joints import EnforcedLimits
    from station.hw.franka.arm.control_mode import ControlMode
    from station.hw.franka.arm.robot_arm import RobotArm
    from station.hw.franka.arm.velocity_curves import VelocityCurves
    from station.hw.franka.commands.cartesian_commands import CartesianCommands
    from station.hw.franka.commands.joint_commands import JointCommands
    from station.hw.franka.commands.rate_limiter import CommandSettings
    from station.memory.vectors import FiniteCheck

# The .pxd declares these as C numbers.
_MOVE = codes.MOVE
_TORQUES = codes.NO_MOTION
_POSITIONS = codes.POSITIONS
_VELOCITIES = codes.VELOCITIES


class Hand(Protocol):
    """The services of a hand."""

    is_moving: bool


class Fingers(Protocol):
    """The fingers of a simulated hand."""

    claimed: dict[str, str]

    @property
    def hand(self) -> Hand:
        """Return the services of the hand with these fingers."""

    def write(self) -> None:
        """Pass the commands of the fingers on."""


class CommandSender:
    """Sends the commands of the present mode. Control thread only.

    Args:
        arm: The arm.
        mode: Number of the arm's mode, shape (1,).
        mode_names: Name of each mode, by its number.
        joints: Joint commands and their limits.
        cartesian: Cartesian commands.
        rates: Filter and rate limits of the joint commands.
        curves: The velocities that each position allows; None if limits do not depend
            on the position.

    Attributes:
        is_active: Whether controllers give any command.
        is_waiting: Whether the arm comes to rest before it follows the commands.
        refusal: Why a command was not sent and the motion ended; None without a reason.
        guard: Keeps the arm clear of its scene; None without a scene.
    """

    def __init__(
        self,
        arm: "RobotArm",
        mode: Doubles,
        mode_names: dict[float, str],
        joints: "JointCommands",
        cartesian: "CartesianCommands",
        rates: CommandRates,
        curves: "VelocityCurves | None" = None,
    ) -> None:
        self.arm = arm
        self.receiver = arm.receiver()
        self.code = mode
        self.last_code = mode[0]
        self.mode_names = mode_names
        self.last_name = mode_names[mode[0]]
        self.joints = joints
        self.cartesian = cartesian
        self.cartesian_sender = cartesian.sender
        self.rates = rates
        self.curves = curves
        self.checks: list[FiniteCheck] = []
        self.limits: list[EnforcedLimits] = []
        self.is_active = self.is_waiting = False
        self.has_positions = False
        self.has_velocities = False
        self.has_efforts = False
        self.has_pose = False
        self.has_twist = False
        self.refusal: str | None = None
        self.guard: Guard | None = None
        self.hand: Hand | None = None
        self.claimed: dict[str, str]
        self.write_fingers: Callable[[], None]

    def add_fingers(self, fingers: Fingers) -> None:
        """Also send the commands of the fingers of a simulated hand."""
        self.hand, self.claimed = fingers.hand, fingers.claimed
        self.write_fingers = fingers.write

    def is_interrupted(self) -> bool:
        """Return whether the arm has left the motion that controllers command."""
        # This is the usual case, decided by one comparison.
        if self.code[0] == _MOVE:
            return False
        return self.is_active and not self.is_waiting

    def mode_name(self) -> str:
        """Return the name of the arm's mode."""
        code = self.code[0]
        # The name is looked up only when the mode changes.
        if code != self.last_code:
            self.last_code, self.last_name = code, self.mode_names[code]
        return self.last_name

    def begin_motion(self, mode: "ControlMode", settings: "CommandSettings") -> None:
        """Take commands of the kinds in `mode` from now on, starting at rest.

        Args:
            mode: Kinds of commands.
            settings: Settings of filter, limits and controller.
        """
        self.refusal = None
        joints, cartesian = self.joints, self.cartesian
        joints.begin_commands(mode)
        cartesian.begin_commands(mode)
        self.checks = [*joints.checks(), *cartesian.checks()]
        self.limits = [limits.enforced for limits in joints.limits()]
        self.has_positions = joints.has_positions
        self.has_velocities = joints.has_velocities
        self.has_efforts = joints.has_efforts
        self.has_pose, self.has_twist = cartesian.has_pose, cartesian.has_twist
        gain, is_limiting = settings.low_pass_gain, settings.rate_limiting
        self.rates.begin_motion(gain, is_limiting)
        self.cartesian_sender.begin_motion(gain, is_limiting)

    def keep_clear(self, guard: "Guard | None") -> None:
        """Let a guard slow all commands from now on; None for no guard."""
        self.guard = self.cartesian_sender.guard = self.arm.guard = guard

    @property
    def bridges_gaps(self) -> bool:
        """Return whether commands fill the cycles that a late loop misses."""
        return self.has_pose

    def write(self, time: float, period: float) -> None:
        """Send the controllers' commands; those of the arm only while a motion runs.

        They are limited and filtered first. The motion ends if a command is not finite.

        Args:
            time: Station time of the cycle [s].
            period: Time since the last cycle [s], >= 0.
        """
        hand, guard = self.hand, self.guard
        # Usually there is nothing to do for the fingers.
        if hand is not None and (self.claimed or hand.is_moving):
            self.write_fingers()
        if self.code[0] != _MOVE:
            if guard is not None:
                guard.look()
            return
        # Checked before limits and filters, which may turn a NaN into a number.
        for check in self.checks:
            if check.first_bad() >= 0:
                self.refuse("a command is not finite")
                return
        if self.has_positions:
            # Noted before limits change them: the arm brakes towards these goals.
            self.rates.note_goals()
        # While time stands still, no rate can be computed.
        if period > 0.0:
            for limits in self.limits:
                limits.enforce(period)
        self.send_all(True)  # noqa: FBT003 - positional in C

    def resend_commands(self) -> None:
        """Send the last commands again in an arm cycle between two loop cycles.

        Poses are extrapolated. Other commands are repeated only with rate limits, which
        turn the repetition into a motion towards the command. Without rate limits the
        same position twice would be a step in velocity, so nothing is sent and the arm
        extrapolates.
        """
        # Otherwise the repeated position would be a step in velocity.
        if self.code[0] == _MOVE and (self.rates.is_limiting or self.has_pose):
            self.send_all(False)  # noqa: FBT003 - positional in C

    def send_all(self, is_new: bool) -> None:  # noqa: FBT001 - positional in C
        """Filter and send the present commands.

        Args:
            is_new: Whether controllers have updated since the last call.
        """
        if self.has_positions:
            self.send_positions()
        if self.has_velocities:
            self.send_velocities()
        if self.has_efforts:
            self.send_torques()
        if not self.has_pose and not self.has_twist:
            return
        try:
            if self.has_pose:
                self.cartesian_sender.send_pose(is_new)
            if self.has_twist:
                self.cartesian_sender.send_twist()
        # The control thread must not raise: the motion ends, and the reason is stored.
        except InvalidCommandError as error:
            self.refuse(error.message.rstrip("."))

    def send_positions(self) -> None:
        """Filter and send the commanded positions."""
        rates = self.rates
        if self.curves is not None:
            self.curves.put(rates.q_d, rates.lowest, rates.highest)
        rates.filter_positions()
        if self.guard is not None:
            self.guard.limit_positions(rates.result)
        # The receiver takes the usual command without a Python call; the method of the
        # arm takes any other command, or refuses it with a reason.
        if not self.receiver.receive(rates.result, _POSITIONS):
            self.arm.command_joint_positions(rates.result)

    def send_velocities(self) -> None:
        """Filter and send the commanded velocities."""
        rates = self.rates
        if self.curves is not None:
            self.curves.put(rates.q_d, rates.lowest, rates.highest)
        rates.filter_velocities()
        if self.guard is not None:
            self.guard.limit_velocities(rates.result)
        if not self.receiver.receive(rates.result, _VELOCITIES):
            self.arm.command_joint_velocities(rates.result)

    def send_torques(self) -> None:
        """Filter and send the commanded torques."""
        rates = self.rates
        rates.filter_torques()
        guard = self.guard
        if guard is not None and not guard.limit_torques(rates.result):
            self.refuse(guard.reflex())
            return
        if not self.receiver.receive(rates.result, _TORQUES):
            self.arm.command_joint_torques(rates.result)

    def refuse(self, reason: str) -> None:
        """End the motion, because a command cannot be sent."""
        self.refusal = reason
        self.arm.stop_motion()
