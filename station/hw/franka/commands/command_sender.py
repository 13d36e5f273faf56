"""Send the commands of controllers to the arm, limited and filtered."""

from typing_extensions import override

from station.core.errors import InvalidCommandError
from station.core.franka.franka_robot_state import MODE
from station.hw.franka.arm.arm_codes import MOVE
from station.hw.franka.arm.control_mode import ControlMode
from station.hw.franka.arm.robot_arm import RobotArm, receivers_of
from station.hw.franka.commands.cartesian_commands import CartesianCommands
from station.hw.franka.commands.command_filter import CommandFilter
from station.hw.franka.commands.command_sending import (
    CommandSending,
    JointSend,
    PositionSend,
    TorqueSend,
    VelocitySend,
)
from station.hw.franka.commands.command_settings import CommandSettings
from station.hw.franka.commands.joint_commands import JointCommands


class CommandSender(CommandSending):
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
        super().__init__()
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
        commands, cartesian = self._commands, self._cartesian
        commands.begin(mode)
        cartesian.begin(mode)
        self.checks = [*commands.checks(), *cartesian.checks()]
        self.limits = [limits.enforced for limits in commands.limits()]
        self.sends = self._sends_of_joints()
        self.goals = self._filter.rates if commands.has_positions else None
        self.is_cartesian = cartesian.has_pose or cartesian.has_twist
        self.pose_send = cartesian.pose_send if cartesian.has_pose else None
        self._filter.begin(
            cutoff_frequency=settings.cutoff_frequency,
            rate_limiting=settings.rate_limiting,
        )
        self._filter.rates.note_goals()

    @override
    def refuse(self) -> None:
        self.refusal = "a command is not finite"
        self._arm.stop_motion()

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
            self._send_once_more()

    def _send_once_more(self) -> None:
        """Filter and send the commands as they are, for one more cycle of the arm."""
        if self._mode[0] != MOVE:
            return
        for one in self.sends:
            one.send()
        if self.is_cartesian:
            self.send_end_effector(is_new=False)

    @override
    def send_end_effector(self, is_new: bool) -> None:
        if self._settings is None:
            return
        try:
            self._cartesian.send(self._settings, is_new=is_new)
        except InvalidCommandError as error:
            self.refusal = error.message.rstrip(".")
            self._arm.stop_motion()

    def _sends_of_joints(self) -> list[JointSend]:
        taken, rates, prepare = self._commands, self._filter.rates, self._filter.prepare
        receivers = receivers_of(self._arm)
        sends: list[JointSend] = []
        if taken.has_positions:
            sends.append(PositionSend(rates, receivers.positions, prepare))
        if taken.has_velocities:
            sends.append(VelocitySend(rates, receivers.velocities, prepare))
        if taken.has_efforts:
            sends.append(TorqueSend(rates, receivers.torques))
        return sends
