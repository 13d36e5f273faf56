"""The part of a simulator's memory that belongs to the joints of one arm."""

from array import array

from station.memory.doubles import Doubles, given_or_zeros


class SimulatorMemory:
    """A simulator's state of n joints side by side, each of shape (n,).

    Quantities that are not given get their own memory, as tests need it.

    Args:
        size: Number of joints.
        positions: Positions [rad].
        velocities: Velocities [rad/s].
        motor_forces: Torques of the motors in the last step [Nm].
        brake_forces: Torques of the brakes in the last step [Nm].
        bias: Coriolis, centrifugal and gravity torques [Nm].
        compensation: Torques of the gravity compensation [Nm].
        constraint_forces: Torques of contacts and mechanical stops [Nm].
        inertia: Elements of the joint-space inertia matrix, any number [kg m^2].
        diagonal: Index in `inertia` of each joint's diagonal element.
        controls: Receives the controls of the motors [Nm].
        limits: Largest torques of the motors [Nm].
        passive_damping: Passive damping of the joints [Nm s/rad].
        armature: Rotor inertia as seen at the joints [kg m^2].
        applied: Receives other torques on the joints, e.g. friction [Nm].
    """

    def __init__(
        self,
        size: int,
        *,
        positions: Doubles | None = None,
        velocities: Doubles | None = None,
        motor_forces: Doubles | None = None,
        brake_forces: Doubles | None = None,
        bias: Doubles | None = None,
        compensation: Doubles | None = None,
        constraint_forces: Doubles | None = None,
        inertia: Doubles | None = None,
        diagonal: memoryview | None = None,
        controls: Doubles | None = None,
        limits: Doubles | None = None,
        passive_damping: Doubles | None = None,
        armature: Doubles | None = None,
        applied: Doubles | None = None,
    ) -> None:
        self.size = size
        self.positions = given_or_zeros(positions, size)
        self.velocities = given_or_zeros(velocities, size)
        self.motor_forces = given_or_zeros(motor_forces, size)
        self.brake_forces = given_or_zeros(brake_forces, size)
        self.bias = given_or_zeros(bias, size)
        self.compensation = given_or_zeros(compensation, size)
        self.constraint_forces = given_or_zeros(constraint_forces, size)
        self.inertia = given_or_zeros(inertia, size)
        self.diagonal = memoryview(array("l", range(size)))
        if diagonal is not None:
            self.diagonal = diagonal
        self.controls = given_or_zeros(controls, size)
        self.limits = given_or_zeros(limits, size)
        self.passive_damping = given_or_zeros(passive_damping, size)
        self.armature = given_or_zeros(armature, size)
        self.applied = given_or_zeros(applied, size)
