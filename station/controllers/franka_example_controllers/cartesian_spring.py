"""Hold the end effector of one arm by a spring, see `station.kernel.pose_spring`.

Differs from the originals: every start begins without stiffness, not only the first
start, and with the null space stiffness that is set.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from station.controllers.franka_arm import LARGEST_STEP
from station.core.franka import Frame, FrankaModelHandle, FrankaStateHandle
from station.core.hardware.interfaces import JointGroup
from station.kernel.doubles import put
from station.kernel.pose_spring import PoseSpring


@dataclass(frozen=True, slots=True)
class Stiffness:
    """Stiffnesses that the spring approaches.

    Attributes:
        translational: Stiffness against translations [N/m], >= 0.
        rotational: Stiffness against rotations [Nm/rad], >= 0.
        nullspace: Stiffness of the joints in the null space [Nm/rad], >= 0.
    """

    translational: float
    rotational: float
    nullspace: float


class CartesianSpring:
    """Holds the end effector of one arm by torques. Control thread only.

    Args:
        joints: The arm's joints, claimed for torques.
        state: The arm's state.
        model: The arm's model.
        is_angle: Whether the rotation error is a rotation vector, as with two arms;
            otherwise it is the vector part of a quaternion.
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
        self._state = state
        self._model = model
        arm = state.get_robot_state()
        self._spring = PoseSpring(
            arm.doubles("q"),
            arm.doubles("dq"),
            arm.doubles("O_T_EE"),
            arm.doubles("tau_J_d"),
            LARGEST_STEP,
            is_angle,
        )

    def pose(self) -> NDArray[np.float64]:
        """Return the measured pose O_T_EE, shape (4, 4)."""
        return np.reshape(self._state.get_robot_state().O_T_EE, (4, 4)).T

    def equilibrium(self) -> list[float]:
        """Return the equilibrium: position [m], then quaternion w x y z, shape (7,)."""
        px, py, pz, x, y, z, w = self._spring.equilibrium
        return [px, py, pz, w, x, y, z]

    def begin(self, nullspace: float) -> None:
        """Make the present pose the equilibrium, and start without stiffness.

        Args:
            nullspace: Stiffness of the null space from the start on [Nm/rad], >= 0.
        """
        self._state.get_robot_state()
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

    def update(self, stiffness: Stiffness) -> None:
        """Command the torques of this cycle, then move on towards the targets."""
        self._state.get_robot_state()
        spring, wanted = self._spring, self._spring.wanted
        put(spring.jacobian, self._model.get_zero_jacobian(Frame.END_EFFECTOR))
        put(spring.coriolis, self._model.get_coriolis())
        wanted[0] = stiffness.translational
        wanted[1] = stiffness.rotational
        wanted[2] = stiffness.nullspace
        spring.run()
        self._joints.set_commands([*spring.torques])
