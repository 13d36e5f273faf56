"""Keep the sample of an end effector's controller: a pose, or a twist."""

from station.core.control.sample_columns import SampleColumns
from station.core.franka.model_sources import ModelSource
from station.core.numerics.arm_chain import turn_to_inner_axes, twist_of
from station.core.numerics.rigid_motion import numbers_of
from station.memory.doubles import Doubles, doubles, zeros
from station.memory.vectors import copy_into

_POSE = 7
_QUATERNION = 4
_TWIST = 6


class EndEffectorSample:
    """Desired and measured motion and their difference; a subclass fills them in.

    Args:
        size: Count of the desired values, and of the measured ones.

    Attributes:
        desired: Desired values, shape (size,).
        actual: Measured values, shape (size,).
        errors: The difference, shape (size,).
        sampled: The columns.
    """

    def __init__(self, size: int) -> None:
        self.size = size
        self.desired = zeros(size)
        self.actual = zeros(size)
        self.errors = zeros(size)
        self.sampled = SampleColumns((
            self.desired,
            self.actual,
            self.errors,
            self.desired,
        ))

    def measure(self) -> None:
        """Write the desired and the measured values."""
        raise NotImplementedError

    def keep(self, time: float) -> None:
        """Keep the sample of a cycle.

        Args:
            time: Station time [s].
        """
        self.measure()
        desired, actual, errors = self.desired, self.actual, self.errors
        for i in range(self.size):
            errors[i] = desired[i] - actual[i]
        self.sampled.keep(time)


class PoseSample(EndEffectorSample):
    """Position [m] and unit quaternion x y z w, desired and measured.

    A rotation has two quaternions. The sample keeps the one nearer to that of the last
    cycle, so that the quaternions of a motion do not jump.

    Args:
        pose: The desired pose, 16 numbers.
        source: Writes the measured pose.

    Attributes:
        near: The quaternion of the last cycle, shape (4,).
    """

    def __init__(self, pose: Doubles, source: ModelSource) -> None:
        super().__init__(_POSE)
        self.pose = pose
        self.source = source
        self.near = doubles([0.0, 0.0, 0.0, 1.0])
        self.actual_pose = zeros(16)
        self.quaternion = self.desired[3:]

    def measure(self) -> None:
        """Write both; see `EndEffectorSample.measure`."""
        near = self.near
        numbers_of(self.pose, near, self.desired)
        copy_into(near, 0, self.quaternion, _QUATERNION)
        self.source.write(self.actual_pose)
        numbers_of(self.actual_pose, near, self.actual)


class TwistSample(EndEffectorSample):
    """Velocity [m/s] and angular velocity [rad/s], desired and measured.

    Args:
        pose: The desired pose, 16 numbers.
        twist: The desired twist in the axes of the base, shape (6,).
        measured_pose: Writes the measured pose.
        jacobian: Writes the Jacobian in the axes of the base.
        dq: Joint velocities [rad/s], shape (n,).

    Attributes:
        is_inner: Whether the twists are kept in the axes of the desired and of the
            measured end effector, instead of those of the base.
    """

    def __init__(
        self,
        pose: Doubles,
        twist: Doubles,
        measured_pose: ModelSource,
        jacobian: ModelSource,
        dq: Doubles,
    ) -> None:
        super().__init__(_TWIST)
        self.pose = pose
        self.twist = twist
        self.measured_pose = measured_pose
        self.source = jacobian
        self.dq = dq
        self.is_inner = False
        self.actual_pose = zeros(16)
        self.jacobian = zeros(_TWIST * len(dq))

    def measure(self) -> None:
        """Write both; see `EndEffectorSample.measure`."""
        self.source.write(self.jacobian)
        twist_of(self.jacobian, self.dq, self.actual)
        if self.is_inner:
            turn_to_inner_axes(self.pose, self.twist, self.desired)
            self.measured_pose.write(self.actual_pose)
            turn_to_inner_axes(self.actual_pose, self.actual, self.actual)
        else:
            copy_into(self.desired, 0, self.twist, _TWIST)
