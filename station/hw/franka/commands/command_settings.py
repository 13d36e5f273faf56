"""The settings with which FrankaHW passes commands on to the arm."""

from dataclasses import dataclass

from station.hw.franka.arm.control_mode import GENERATOR_OF_MODE, ControlMode
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.commands.rate_limiter import low_pass_gain

_CARTESIAN = ControlMode.CARTESIAN_POSE | ControlMode.CARTESIAN_VELOCITY


@dataclass(frozen=True, slots=True)
class CommandSettings:
    """Settings of the path from a controller to the arm; read before every switch.

    Attributes:
        rate_limiting: Whether commands are kept within velocity, acceleration and jerk
            limits.
        cutoff_frequency: Cutoff frequency of the low-pass filter on commands [Hz], > 0;
            a frequency of 1000 Hz or more turns the filter off.
        internal_controller: Controller of the arm that computes the torques of a motion
            for which no controller of the station commands torques. None: in Cartesian
            motions the controller whose impedance was set last, in other motions joint
            impedance.
    """

    rate_limiting: bool
    cutoff_frequency: float
    internal_controller: ControllerMode | None

    @property
    def low_pass_gain(self) -> float:
        """Share of a new command in the low-pass filter, 0 to 1; 1 is off."""
        return low_pass_gain(self.cutoff_frequency)

    def arm_modes(
        self, mode: ControlMode, impedance: ControllerMode
    ) -> tuple[ControllerMode, MotionGeneratorMode]:
        """Return the modes in which the arm carries out the commands of controllers.

        Args:
            mode: Kinds of commands of the controllers; supported, and not NONE.
            impedance: The controller whose impedance was set last.
        """
        generator = GENERATOR_OF_MODE[mode & ~ControlMode.JOINT_TORQUE]
        if mode & ControlMode.JOINT_TORQUE:
            return ControllerMode.EXTERNAL_CONTROLLER, generator
        chosen = self.internal_controller
        if chosen is None:
            # The stiffness set for the end effector acts in Cartesian motions; motions
            # of joints keep following their positions.
            is_cartesian = mode & _CARTESIAN
            chosen = impedance if is_cartesian else ControllerMode.JOINT_IMPEDANCE
        return chosen, generator
