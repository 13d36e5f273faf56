"""Desired and measured states of joints, and their differences."""

from math import inf

from station.controllers.set_point_controller import ControlledJoints
from station.core.description.robot_description import JointDescription
from station.core.description.urdf import JointType
from station.core.hardware.interfaces import JointStateGroup
from station.core.numerics.joint_errors import CONTINUOUS, PLAIN, JointErrors
from station.core.trajectory import StateTolerances
from station.core.trajectory.splines import SplineGroup
from station.memory.doubles import Doubles, zeros


class JointTracking:
    """The states of n joints as doubles, always in the same memory. Control thread.

    Args:
        joints: The joints.
        group: Their handles, in the same order.

    Attributes:
        memory: Measured positions and velocities, and the commands.
        desired: Desired positions, velocities and accelerations one after the other,
            shape (3 n,).
        positions: Desired positions [rad or m], shape (n,), a part of `desired`.
        velocities: Desired velocities [rad/s or m/s], shape (n,).
        accelerations: Desired accelerations [rad/s^2 or m/s^2], shape (n,).
        errors: Desired minus measured positions [rad or m], shape (n,); those of
            continuous joints are the shorter ways round.
        rate_errors: Desired minus measured velocities [rad/s or m/s], shape (n,).
        splines: Computes desired states and errors.
    """

    def __init__(self, joints: list[JointDescription], group: JointStateGroup) -> None:
        size = len(joints)
        self.memory = ControlledJoints(group)
        self.desired = zeros(3 * size)
        self.positions: Doubles = self.desired[:size]
        self.velocities: Doubles = self.desired[size : 2 * size]
        self.accelerations: Doubles = self.desired[2 * size :]
        self.errors, self.rate_errors = zeros(size), zeros(size)
        memory = self.memory
        self._position = JointErrors(self.positions, memory.positions, self.errors)
        self._velocity = JointErrors(
            self.velocities, memory.velocities, self.rate_errors
        )
        self.splines = SplineGroup(self.desired, self._position, self._velocity)
        # The bounds of zero that the comparisons start with are none of these.
        self._bounds: list[StateTolerances | None] = [StateTolerances()] * size
        for index, joint in enumerate(joints):
            wrapping = CONTINUOUS if joint.type is JointType.CONTINUOUS else PLAIN
            self._position.set_wrapping(index, wrapping, joint.lower, joint.upper)

    def set_bounds(self, index: int, bounds: StateTolerances | None) -> None:
        """Set the errors beyond which `splines` says so; None for no bounds.

        Args:
            index: Index of the joint.
            bounds: Largest errors of position and velocity.
        """
        if bounds is self._bounds[index]:
            return
        self._bounds[index] = bounds
        position = velocity = inf
        if bounds is not None:
            position, velocity = bounds.position, bounds.velocity
        self._position.set_bound(index, position if position > 0.0 else inf)
        self._velocity.set_bound(index, velocity if velocity > 0.0 else inf)
