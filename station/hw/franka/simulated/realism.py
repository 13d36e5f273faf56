"""The differences between a real Franka arm and an ideal one, with their sources.

The figures of the sensors come from a published recording of a Panda: 19 s of an
exciting trajectory with the joint torques, positions and velocities of every cycle, in
the repository of [1] (matlab/data/Exciting_Traj/Trajectory_1/rbt_log). White noise is
the median absolute third difference over 0.6745 sqrt(20). Bias and model error are mean
and spread of the torques that remain after inverse dynamics of the URDF (without a
hand, filtered at 10 Hz) and after the friction of [1]; the spread is given as a share
of the spread of the torques.

[1] C. Gaz, M. Cognetti, A. Oliva, P. Robuffo Giordano, A. De Luca: Dynamic
    Identification of the Franka Emika Panda Robot With Retrieval of Feasible Parameters
    Using Penalty-Based Optimization. IEEE Robotics and Automation Letters 4(4), 2019.
    https://github.com/marcocognetti/FrankaEmikaPandaDynModel
[2] franka_emulator of the Institute for Data Science in Mechanical Engineering, RWTH
    Aachen: model/franka_emulator/model.urdf, `friction`, as measured on a Panda by
    source/emulator/friction_calibrator.cpp: a torque that grows by 0.5 Nm/s turns a
    resting joint by 0.5 degrees.
    https://github.com/Data-Science-in-Mechanical-Engineering/franka_emulator
[3] Franka Control Interface documentation, Getting started, the output of
    echo_robot_state: `theta`, `q` and `tau_J` of one moment.
[4] Franka Control Interface documentation, Minimum system and network requirements: the
    round trip, the client's computation, and the robot's processing and its step of the
    internal controller must take less than 1 ms together, or the command is dropped. It
    acts when that millisecond is over.
"""

from dataclasses import dataclass, replace


@dataclass(frozen=True, slots=True)
class Realism:
    """The disturbances of an arm; tuples have one number per joint, shape (7,).

    Attributes:
        friction_level: Friction at high speed forwards plus friction backwards [Nm].
        friction_slope: Steepness of the rise of the friction with the speed [s/rad].
        friction_shift: Makes the friction larger in one direction; 0 for equal [rad/s].
        viscous: Friction in proportion to the speed [Nm s/rad].
        static_friction: Largest torque at which a joint stays at rest [Nm].
        stribeck_velocity: Speed at which half of this torque is left [rad/s].
        presliding: Angle by which a joint turns before it slides [rad].
        joint_stiffness: Stiffness between motor and link [Nm/rad]: `theta` differs from
            `q` by the torque over the stiffness. The links move as if the joint were
            rigid.
        torque_noise: Standard deviation of the torque sensors in a cycle [Nm].
        torque_bias: Constant error of the torque sensors [Nm].
        velocity_noise: Standard deviation of the velocities in a cycle [rad/s].
        model_error: Relative error of gravity and Coriolis torques in the arm's own
            model.
        torque_error: Error that bias, friction and model error together cause in the
            estimated external torques, in one direction of the joints [Nm].
        observer_frequency: Cutoff of the observer of external torques [Hz].
        losses: Share of the cycles in which a command is lost on its way, 0 to 1.
        commands_are_late: Whether a command acts in the cycle after the one in which
            the arm reports it as desired.
        seed: Seed of the random numbers.
    """

    friction_level: tuple[float, ...]
    friction_slope: tuple[float, ...]
    friction_shift: tuple[float, ...]
    viscous: tuple[float, ...]
    static_friction: tuple[float, ...]
    stribeck_velocity: float
    presliding: float
    joint_stiffness: tuple[float, ...]
    torque_noise: tuple[float, ...]
    torque_bias: tuple[float, ...]
    velocity_noise: tuple[float, ...]
    model_error: tuple[float, ...]
    torque_error: float
    observer_frequency: float
    losses: float
    commands_are_late: bool
    seed: int = 0

    def with_friction(self, joint: int, coulomb: float, viscous: float) -> "Realism":
        """Return the arm with the identified friction of a joint.

        The shape of the friction near rest is kept, and the static friction in
        proportion, because the motions of an identification do not show them.

        Args:
            joint: Number of the joint, from 0.
            coulomb: Mean friction of both directions without the viscous part [Nm].
            viscous: Viscous friction [Nm s/rad].
        """
        level = 2.0 * coulomb
        static = self.static_friction[joint] * level / self.friction_level[joint]
        return replace(
            self,
            friction_level=_put(self.friction_level, joint, level),
            static_friction=_put(self.static_friction, joint, static),
            viscous=_put(self.viscous, joint, viscous),
        )


def _put(values: tuple[float, ...], index: int, value: float) -> tuple[float, ...]:
    return (*values[:index], value, *values[index + 1 :])


TYPICAL = Realism(
    # [1], table of friction coefficients, and franka_model.h.
    friction_level=(0.54615, 0.87224, 0.64068, 1.2794, 0.83904, 0.30301, 0.56489),
    friction_slope=(5.1181, 9.0657, 10.136, 5.5903, 8.3469, 17.133, 10.336),
    friction_shift=(0.03953, 0.02588, -0.04607, 0.03619, 0.02623, -0.02105, 0.00355),
    viscous=(0.0,) * 7,  # [1] has none
    # The torques of [2], 0.83, 1.00, 0.89, 1.29, 0.81, 0.59 and 0.41 Nm, minus the
    # increase of the torque while the joint begins to slide.
    static_friction=(0.70, 0.79, 0.725, 1.145, 0.75, 0.515, 0.34),
    # Assumptions: not published. From 0.1 rad/s on, the static friction adds
    # less than 0.05 Nm to the curve of [1]; below, a joint turns by less than the
    # repeatability of 0.1 mm at the end of the arm.
    stribeck_velocity=0.02,
    presliding=1e-4,
    # [3]: (theta - q) K = tau_J holds for all joints, to the last digit shown.
    joint_stiffness=(7000.0,) * 7,
    # From the recording, see above.
    torque_noise=(0.059, 0.050, 0.059, 0.050, 0.024, 0.025, 0.040),
    torque_bias=(-0.15, -0.40, 0.01, 0.03, -0.02, 0.03, 0.0),
    velocity_noise=(0.0027, 0.0031, 0.0026, 0.0028, 0.0025, 0.0032, 0.0033),
    model_error=(0.09, 0.025, 0.025, 0.05, 0.15, 0.09, 0.24),
    # The effect of the figures above: in 1000 random motions in the whole range of the
    # joints at most 2.7 Nm in the weakest direction of the wrench, 1.9 Nm in 99.9 %.
    torque_error=2.0,
    # Assumptions: not published. With 15 Hz the noise of the estimate stays
    # below 0.5 Nm, far below the smallest default threshold, and a contact is reported
    # within the 50 ms that the Panda's data sheet names as reaction time.
    observer_frequency=15.0,
    # libfranka's examples/communication_test.cpp calls 95 % of received commands
    # acceptable; a good network loses one in a thousand.
    losses=0.001,
    commands_are_late=True,  # [4]
)
"""A Panda with its measured disturbances."""
