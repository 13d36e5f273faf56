"""Low-pass filter and rate limits of an arm's commands, and their settings.

The formulas are in `core.numerics.command_rates`; their numbers are here, as libfranka
has them. `PERIOD` is libfranka's fixed cycle of 1 ms.

Source: libfranka@0.9.2 src/lowpass_filter.cpp, lowpassFilter; src/rate_limiting.cpp,
limitRate; include/franka/rate_limiting.h, the limits of the Panda; libfranka@0.15.0,
the same files, for the FR3.
"""

from dataclasses import dataclass
from math import pi

from station.core.franka.franka_robot_state import RobotState
from station.core.numerics.command_rates import CommandRates
from station.hw.franka.arm.arm_limits import ArmLimits, MotionLimits
from station.hw.franka.arm.control_mode import GENERATOR_OF_MODE, ControlMode
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.arm.velocity_curves import VelocityCurves
from station.hw.franka.commands.joint_commands import JointCommands

PERIOD = 0.001
"""Cycle of the arm [s]."""
MAX_CUTOFF_FREQUENCY = 1000.0
"""Cutoff frequency at and above which the low-pass filter is off [Hz]."""
MARGIN = 1e-3
"""Margin subtracted from every limit, in the unit of the limit."""
# A joint approaches its goal with half of the acceleration limit, and near the goal
# with a velocity in proportion to the distance [1/s]. Where both apply, the
# deceleration is up to twice as large, so the other half of the limit is needed.
_BRAKING_SHARE = 0.5
_APPROACH_GAIN = 50.0
_CARTESIAN = ControlMode.CARTESIAN_POSE | ControlMode.CARTESIAN_VELOCITY


def rate_limits_of(limits: ArmLimits) -> tuple[MotionLimits, ...]:
    """Return the limits of an arm's joints, with libfranka's margins, shape (7,).

    Args:
        limits: The arm's own limits.
    """
    return tuple(
        with_margins(MotionLimits(*bounds), limits.tolerated_losses)
        for bounds in zip(
            limits.velocity, limits.acceleration, limits.jerk, strict=True
        )
    )


def with_margins(limits: MotionLimits, tolerated_losses: int) -> MotionLimits:
    """Return limits reduced by libfranka's margins.

    Args:
        limits: The arm's own limits of a motion.
        tolerated_losses: Number of lost packets for which the velocity leaves room; the
            arm continues with constant acceleration meanwhile.
    """
    acceleration = limits.acceleration - MARGIN
    reserve = tolerated_losses * PERIOD * acceleration
    return MotionLimits(
        limits.velocity - MARGIN - reserve, acceleration, limits.jerk - MARGIN
    )


def low_pass_gain(cutoff_frequency: float) -> float:
    """Return the share of a new command in the low-pass, 0 to 1; 1 is off.

    Args:
        cutoff_frequency: Cutoff frequency [Hz], > 0; `MAX_CUTOFF_FREQUENCY` and above
            is off.
    """
    if cutoff_frequency >= MAX_CUTOFF_FREQUENCY:
        return 1.0
    return PERIOD / (PERIOD + 1.0 / (2.0 * pi * cutoff_frequency))


def make_joint_rates(
    limits: ArmLimits, state: RobotState, commands: JointCommands
) -> CommandRates:
    """Return the filter and the rate limits of an arm's joint commands.

    Each new command is compared with the desired values that the arm reports, so the
    filter starts smoothly from every earlier motion. Unlike in libfranka's
    convertMotion, a position command that breaks the limits, e.g. a step, is approached
    not at full speed, but at a velocity from which the arm can stop there. Commands
    within the limits pass unchanged, as in libfranka.

    Args:
        limits: The arm's own limits.
        state: The arm's state.
        commands: The commands after the joint limits.

    Source:
        libfranka@0.9.2 src/control_loop.cpp, convertMotion, ControlLoop::spinControl.
    """
    rates = rate_limits_of(limits)
    lower, upper = commands.range()
    names = ("tau_J_d", "q_d", "dq_d", "ddq_d")
    return CommandRates(
        **{name: state.doubles(name) for name in names},
        positions=commands.positions,
        velocities=commands.velocities,
        efforts=commands.efforts,
        velocity=[one.velocity for one in rates],
        acceleration=[one.acceleration for one in rates],
        jerk=[one.jerk for one in rates],
        torque_rate=limits.torque_rate - MARGIN,
        lower=lower,
        upper=upper,
        braking_share=_BRAKING_SHARE,
        approach_gain=_APPROACH_GAIN,
        period=PERIOD,
        passes_first=not limits.filters_first_pose,
    )


def make_velocity_curves(limits: ArmLimits) -> VelocityCurves | None:
    """Return the velocities that each position allows, with libfranka's margin.

    None if the limits do not depend on the position. Limits that depend on it leave no
    room for lost packets.

    Args:
        limits: The arm's own limits.

    Source:
        libfranka@0.15.0 include/franka/rate_limiting.h,
        computeUpperLimitsJointVelocity, computeLowerLimitsJointVelocity; differs: the
        margin does not make a range of 0 negative.
    """
    if not limits.curves:
        return None
    return VelocityCurves(limits.velocity, limits.curves, [MARGIN] * 7)


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
