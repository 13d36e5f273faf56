"""Send the commands of controllers to the arm, limited and filtered."""

from collections.abc import Callable
from typing import TypeAlias

from station.core.errors import InvalidCommandError
from station.core.franka.franka_robot_state import MODE
from station.hw.franka.arm.control_mode import ControlMode
from station.hw.franka.arm.robot_arm import RobotArm
from station.hw.franka.commands.cartesian_commands import CartesianCommands
from station.hw.franka.commands.command_filter import CommandFilter
from station.hw.franka.commands.command_settings import CommandSettings
from station.hw.franka.commands.joint_commands import JointCommands
from station.kernel.arm_codes import MOVE
from station.kernel.doubles import Doubles

_Send: TypeAlias = tuple[Callable[[], object], Doubles, Callable[[Doubles], None]]
"""What filters commands, where the result is, and what passes the result on."""


class CommandSender:
    """Sends the commands of the present mode. Control thread only.

    Args:
        arm: The arm.
        commands: Joint commands and their limits.
        cartesian: Cartesian commands.
        command_filter: Filter and rate limits of the joint commands.

    Attributes:
        refusal: Why a command was not sent and the motion ended; None if all were sent.
    """

    def __init__(
        self,
        arm: RobotArm,
        commands: JointCommands,
        cartesian: CartesianCommands,
        command_filter: CommandFilter,
    ) -> None:
        self._arm = arm
        self._commands = commands
        self._cartesian = cartesian
        self._filter = command_filter
        self._mode = arm.state.doubles(MODE)
        self._settings: CommandSettings | None = None
        self._searches: tuple[Callable[[], int], ...] = ()
        self._limits: tuple[Callable[[float], None], ...] = ()
        self._joint_sends: tuple[_Send, ...] = ()
        self._is_cartesian = False
        self.refusal: str | None = None

    def begin(self, mode: ControlMode, settings: CommandSettings) -> None:
        """Take commands of the kinds in `mode` from now on, seeded with rest.

        Args:
            mode: What is commanded.
            settings: How it is passed on.
        """
        self._settings = settings
        self.refusal = None
        commands, cartesian = self._commands, self._cartesian
        commands.begin(mode)
        cartesian.begin(mode)
        checks = (*commands.checks(), *cartesian.checks())
        self._searches = tuple(check.first_bad for check in checks)
        self._limits = tuple(limits.enforce_limits for limits in commands.limits())
        self._joint_sends = self._sends_of_joints()
        self._is_cartesian = cartesian.has_pose or cartesian.has_twist
        self._filter.begin(
            cutoff_frequency=settings.cutoff_frequency,
            rate_limiting=settings.rate_limiting,
        )
        self._filter.note_goals()

    def send_limited(self, period: float) -> None:
        """Limit and send the controllers' commands, while a motion runs.

        The motion ends, and `refusal` has the reason, when a command is not finite.

        Args:
            period: Time since the last cycle [s], >= 0.
        """
        for first_bad in self._searches:
            if first_bad() >= 0:
                self.refusal = "a command is not finite"
                self._arm.stop_motion()
                return
        if self._commands.has_positions:
            self._filter.note_goals()
        if period > 0.0:
            for enforce in self._limits:
                enforce(period)
        self.send(is_new=True)

    @property
    def bridges_gaps(self) -> bool:
        """Whether FrankaHW fills the cycles that a late loop misses."""
        return self._cartesian.has_pose

    def send_again(self) -> None:
        """Send the last commands again in an arm cycle between two loop cycles.

        Poses are extrapolated. Other commands are repeated only with rate limits, which
        turn the repetition into a motion towards the command. Without rate limits the
        same position twice would be a step in velocity, so nothing is sent and the arm
        extrapolates.
        """
        limits_rates = self._settings is not None and self._settings.rate_limiting
        if limits_rates or self.bridges_gaps:
            self.send()

    def send(self, *, is_new: bool = False) -> None:
        """Filter and send the commands as they are, for one cycle of the arm.

        Args:
            is_new: Controllers have updated since the last send.
        """
        if self._mode[0] != MOVE:
            return
        for filter_commands, result, command in self._joint_sends:
            filter_commands()
            command(result)
        if self._is_cartesian and self._settings:
            try:
                self._cartesian.send(self._settings, is_new=is_new)
            except InvalidCommandError as error:
                self.refusal = error.message.rstrip(".")
                self._arm.stop_motion()

    def _sends_of_joints(self) -> tuple["_Send", ...]:
        arm, taken, filtered = self._arm, self._commands, self._filter
        kinds = (
            (taken.has_positions, filtered.positions, arm.command_joint_positions),
            (taken.has_velocities, filtered.velocities, arm.command_joint_velocities),
            (taken.has_efforts, filtered.torques, arm.command_joint_torques),
        )
        return tuple(
            (filter_commands, filtered.result, command)
            for is_taken, filter_commands, command in kinds
            if is_taken
        )
