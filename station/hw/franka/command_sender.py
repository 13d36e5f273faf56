"""What FrankaHW sends to the arm in each of its cycles: limited and filtered."""

from station.core.errors import InvalidCommandError
from station.core.interfaces.franka_robot_state import RobotMode
from station.hw.franka.cartesian_commands import CartesianCommands
from station.hw.franka.command_filter import CommandFilter
from station.hw.franka.control_mode import GENERATOR_OF_MODE, ControlMode
from station.hw.franka.franka_parameters import CommandSettings
from station.hw.franka.joint_commands import JointCommands
from station.hw.franka.robot_arm import ControllerMode, MotionGeneratorMode, RobotArm


class CommandSender:
    """Sends the commands of the present mode. Control thread only.

    Args:
        arm: The arm.
        commands: Joint commands and their limits.
        cartesian: Cartesian commands.
        command_filter: Filter and rate limits of the joint commands.
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
        self._settings: CommandSettings | None = None
        self._goals: list[float] = []

    def begin(self, mode: ControlMode, settings: CommandSettings) -> None:
        """Take commands of the kinds in `mode` from now on, seeded with rest.

        Args:
            mode: What is commanded.
            settings: How it is passed on.
        """
        self._settings = settings
        self._commands.begin(mode)
        self._cartesian.begin(mode)
        self._goals = self._commands.goals()
        self._filter.begin(
            cutoff_frequency=settings.cutoff_frequency,
            rate_limiting=settings.rate_limiting,
        )

    def send_limited(self, period: float) -> None:
        """Limit and send the controllers' commands; the arm stops if one is no number.

        Args:
            period: Time since the last cycle [s], >= 0.
        """
        commands = self._commands
        if self._arm.state.robot_mode is not RobotMode.MOVE:
            return
        if not (commands.are_finite() and self._cartesian.are_finite()):
            self._arm.stop_motion()
            return
        self._goals = commands.goals()
        if period > 0.0:
            commands.enforce_limits(period)
        self._cartesian.note(period)
        self._send()

    def send_between(self) -> None:
        """Send what continues the motion, for a cycle of the arm between two updates.

        The filter of joint commands comes nearer to them; a pose moves on.
        """
        if self._arm.state.robot_mode is RobotMode.MOVE:
            self._cartesian.go_on()
            self._send()

    def _send(self) -> None:
        self._send_joints()
        if self._settings and (self._cartesian.has_pose or self._cartesian.has_twist):
            try:
                self._cartesian.send(self._settings)
            except InvalidCommandError:
                self._arm.stop_motion()

    def _send_joints(self) -> None:
        arm, commands, state = self._arm, self._commands, self._arm.state
        goals, filtered = self._goals, self._filter
        if commands.has_positions:
            q = filtered.positions(commands.positions, state, goals=goals)
            arm.command_joint_positions(q)
        if commands.has_velocities:
            dq = filtered.velocities(commands.velocities, state)
            arm.command_joint_velocities(dq)
        if commands.has_efforts:
            arm.command_joint_torques(filtered.torques(commands.efforts, state))


def arm_modes(
    mode: ControlMode, settings: CommandSettings
) -> tuple[ControllerMode, MotionGeneratorMode]:
    """Return what the arm has to be told for a supported mode that is not NONE."""
    generator = GENERATOR_OF_MODE[mode & ~ControlMode.JOINT_TORQUE]
    if mode & ControlMode.JOINT_TORQUE:
        return ControllerMode.EXTERNAL_CONTROLLER, generator
    return settings.internal_controller, generator
