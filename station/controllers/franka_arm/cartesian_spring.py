"""Hold end effectors by springs, one for each arm; `pose_spring` has the formulas.

Differs from the originals: every start begins without stiffness, not only the first
start, and with the null space stiffness that is set.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from station.controllers.franka_arm.arm_handles import LARGEST_STEP
from station.controllers.franka_arm.pose_spring import PoseSpring
from station.core.franka import Frame, FrankaModelHandle, FrankaStateHandle
from station.core.hardware.interfaces import JointGroup
from station.core.ports.set_point import SetPointPort
from station.core.toolbox.publish_timer import PublishTimer
from station.memory.doubles import put
from station.memory.vectors import copy_into


class CartesianSpring:
    """Holds the end effector of one arm by torques. Control thread only.

    Args:
        joints: The arm's joints, claimed for torques.
        state: The arm's state.
        model: The arm's model.
        is_angle: Whether the rotation error is a rotation vector, as with two arms;
            otherwise it is the vector part of a quaternion.
        law: Class of the spring.

    Attributes:
        spring: Computes the torques.
    """

    def __init__(
        self,
        joints: JointGroup,
        state: FrankaStateHandle,
        model: FrankaModelHandle,
        *,
        is_angle: bool,
        law: type[PoseSpring] = PoseSpring,
    ) -> None:
        self._pose = state.pose_source()
        self._jacobian = model.zero_jacobian_source(Frame.END_EFFECTOR)
        self._coriolis = model.coriolis_source()
        arm = state.get_robot_state()
        self.spring = law(
            arm.doubles("q"),
            arm.doubles("dq"),
            arm.doubles("tau_J_d"),
            LARGEST_STEP,
            is_angle,
        )
        # Joints that the robot does not keep side by side in doubles take a list.
        self._copies = joints if joints.commands is None else None
        commands = joints.commands
        self._commands = self.spring.torques if commands is None else commands

    def pose(self) -> list[float]:
        """Return the measured pose O_T_EE, 16 numbers, column-major."""
        self._pose.write(self.spring.pose)
        return self.measured_pose()

    def measured_pose(self) -> list[float]:
        """Return the pose that was measured in the last cycle, 16 numbers."""
        return list(self.spring.pose)

    def equilibrium(self) -> list[float]:
        """Return the equilibrium: position [m], then quaternion w x y z, shape (7,)."""
        px, py, pz, x, y, z, w = self.spring.equilibrium
        return [px, py, pz, w, x, y, z]

    def start_at_rest(self, nullspace: float) -> None:
        """Make the present pose the equilibrium, and start without stiffness.

        Args:
            nullspace: Stiffness of the null space from the start on [Nm/rad], >= 0.
        """
        self._pose.write(self.spring.pose)
        self.spring.start_at_rest(nullspace)

    def set_target(
        self, position: NDArray[np.float64], rotation: NDArray[np.float64]
    ) -> None:
        """Set the equilibrium that is approached from now on.

        Args:
            position: In the base frame [m], shape (3,).
            rotation: Unit quaternion w x y z, shape (4,).
        """
        w, x, y, z = rotation.tolist()
        put(self.spring.target, [*position.tolist(), x, y, z, w])

    def set_stiffness(
        self, translational: float, rotational: float, nullspace: float
    ) -> None:
        """Set the stiffnesses that are approached from now on.

        Args:
            translational: Stiffness against translations [N/m], >= 0.
            rotational: Stiffness against rotations [Nm/rad], >= 0.
            nullspace: Stiffness of the joints in the null space [Nm/rad], >= 0.
        """
        put(self.spring.wanted, (translational, rotational, nullspace))

    def command_torques(self) -> None:
        """Command the torques of this cycle, then move on towards the targets."""
        spring = self.spring
        self._pose.write(spring.pose)
        self._jacobian.write(spring.jacobian)
        self._coriolis.write(spring.coriolis)
        spring.compute_torques()
        if self._copies is None:
            copy_into(self._commands, 0, spring.torques, spring.size)
        else:
            self._copies.set_commands(list(spring.torques))


class SpringUpdate:
    """The update of a controller that commands springs.

    Args:
        port: Receives the set-points.
        retarget: Sets the targets of the springs; called when the set-point in force
            may have changed.
        springs: The springs.
        timer: Tells when to publish.

    Attributes:
        published: Station time [s] and pose of the first spring's end effector, 16
            numbers, when it was published last; replaced as a whole, for any thread.
    """

    def __init__(
        self,
        port: SetPointPort,
        retarget: Callable[[], None],
        springs: list[CartesianSpring],
        timer: PublishTimer,
    ) -> None:
        self.port = port
        self.retarget = retarget
        self.springs = springs
        self.timer = timer
        self.published: tuple[float, list[float]] | None = None

    def command_springs(self, time: float) -> None:
        """Take the newest set-point, and command the springs.

        Args:
            time: Station time of the cycle [s].

        Raises:
            CommandTimeoutError: The set-point has expired and the action is `stop`.
        """
        if self.port.has_changed():
            self.retarget()
        for spring in self.springs:
            spring.command_torques()
        if self.timer.is_due(time):
            self.published = (time, self.springs[0].measured_pose())
