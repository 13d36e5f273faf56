"""Hold the end effector of one arm by a spring; `pose_spring` has the formulas.

Differs from the originals: every start begins without stiffness, not only the first
start, and with the null space stiffness that is set.
"""

import numpy as np
from numpy.typing import NDArray

from station.controllers.franka_arm import LARGEST_STEP
from station.controllers.franka_example_controllers.pose_spring import PoseSpring
from station.controllers.franka_example_controllers.spring_update import DrivenSpring
from station.core.franka import Frame, FrankaModelHandle, FrankaStateHandle
from station.core.hardware.interfaces import JointGroup
from station.memory.doubles import put


class CartesianSpring:
    """Holds the end effector of one arm by torques. Control thread only.

    Args:
        joints: The arm's joints, claimed for torques.
        state: The arm's state.
        model: The arm's model.
        is_angle: Whether the rotation error is a rotation vector, as with two arms;
            otherwise it is the vector part of a quaternion.

    Attributes:
        driven: Commands the torques of a cycle.
        is_copy: Whether the torques must be written to the joints after that.
    """

    def __init__(
        self,
        joints: JointGroup,
        state: FrankaStateHandle,
        model: FrankaModelHandle,
        *,
        is_angle: bool,
    ) -> None:
        self._joints = joints
        self._pose = state.pose_source()
        arm = state.get_robot_state()
        self._spring = PoseSpring(
            arm.doubles("q"),
            arm.doubles("dq"),
            arm.doubles("tau_J_d"),
            LARGEST_STEP,
            is_angle,
        )
        self.is_copy = joints.commands is None
        self.driven = DrivenSpring(
            self._spring,
            self._pose,
            model.zero_jacobian_source(Frame.END_EFFECTOR),
            model.coriolis_source(),
            self._spring.torques if joints.commands is None else joints.commands,
        )

    def pose(self) -> list[float]:
        """Return the measured pose O_T_EE, 16 numbers, column-major."""
        self._pose.write(self._spring.pose)
        return [*self._spring.pose]

    def equilibrium(self) -> list[float]:
        """Return the equilibrium: position [m], then quaternion w x y z, shape (7,)."""
        px, py, pz, x, y, z, w = self._spring.equilibrium
        return [px, py, pz, w, x, y, z]

    def begin(self, nullspace: float) -> None:
        """Make the present pose the equilibrium, and start without stiffness.

        Args:
            nullspace: Stiffness of the null space from the start on [Nm/rad], >= 0.
        """
        self._pose.write(self._spring.pose)
        self._spring.begin(nullspace)

    def set_target(
        self, position: NDArray[np.float64], rotation: NDArray[np.float64]
    ) -> None:
        """Set the equilibrium that is approached from now on.

        Args:
            position: In the base frame [m], shape (3,).
            rotation: Unit quaternion w x y z, shape (4,).
        """
        w, x, y, z = rotation.tolist()
        put(self._spring.target, [*position.tolist(), x, y, z, w])

    def want(self, translational: float, rotational: float, nullspace: float) -> None:
        """Set the stiffnesses that are approached from now on.

        Args:
            translational: Stiffness against translations [N/m], >= 0.
            rotational: Stiffness against rotations [Nm/rad], >= 0.
            nullspace: Stiffness of the joints in the null space [Nm/rad], >= 0.
        """
        put(self._spring.wanted, (translational, rotational, nullspace))

    def write(self) -> None:
        """Hand the torques to joints that do not keep them side by side in memory."""
        if self.is_copy:
            self._joints.set_commands([*self._spring.torques])
