"""Send the commands of controllers to the arm, limited and filtered."""

from station.core.errors import InvalidCommandError
from station.core.franka.franka_robot_state import MODE
from station.hw.franka.arm.control_mode import ControlMode
from station.hw.franka.arm.robot_arm import RobotArm
from station.hw.franka.commands.cartesian_commands import CartesianCommands
from station.hw.franka.commands.command_filter import CommandFilter
from station.hw.franka.commands.command_settings import CommandSettings
from station.hw.franka.commands.joint_commands import JointCommands
from station.kernel.arm_codes import MOVE


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
        self.refusal: str | None = None

    def begin(self, mode: ControlMode, settings: CommandSettings) -> None:
        """Take commands of the kinds in `mode` from now on, seeded with rest.

        Args:
            mode: What is commanded.
            settings: How it is passed on.
        """
        self._settings = settings
        self.refusal = None
        self._commands.begin(mode)
        self._cartesian.begin(mode)
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
        commands, cartesian = self._commands, self._cartesian
        if not commands.are_finite() or not cartesian.are_finite():
            self.refusal = "a command is not finite"
            self._arm.stop_motion()
            return
        if commands.has_positions:
            self._filter.note_goals()
        if period > 0.0:
            commands.enforce_limits(period)
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
        arm, commands, filtered = self._arm, self._commands, self._filter
        if self._mode[0] != MOVE:
            return
        if commands.has_positions:
            arm.command_joint_positions(filtered.positions())
        if commands.has_velocities:
            arm.command_joint_velocities(filtered.velocities())
        if commands.has_efforts:
            arm.command_joint_torques(filtered.torques())
        if self._settings and (self._cartesian.has_pose or self._cartesian.has_twist):
            try:
                self._cartesian.send(self._settings, is_new=is_new)
            except InvalidCommandError as error:
                self.refusal = error.message.rstrip(".")
                arm.stop_motion()
