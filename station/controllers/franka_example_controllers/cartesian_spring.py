"""A spring between the end effector of one arm and an equilibrium pose.

    tau = J^T (-K e - D J dq) + (I - J^T (J^T)^+) (k (q_n - q) - 2 sqrt(k) dq) + c

Here J is the Jacobian of the end effector and (J^T)^+ a damped pseudo-inverse; e is the
pose error; K is the stiffness and D = 2 sqrt(K) the damping; q_n are the joint
positions at the start, to which a spring of stiffness k pulls in the null space; c are
the Coriolis torques. Stiffnesses and equilibrium approach their targets through a
low-pass filter, because a jump would make the torques jump.

Source: franka_ros@c11f000 franka_example_controllers,
src/cartesian_impedance_example_controller.cpp and
dual_arm_cartesian_impedance_example_controller.cpp, the part that both share; differs:
every start begins without stiffness, not only the first start, and with the null space
stiffness that is set.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from station.controllers.franka_arm import saturate_torque_rate
from station.controllers.franka_example_controllers.quaternion import (
    quaternion_of,
    slerp,
)
from station.core.franka import Frame, FrankaModelHandle, FrankaStateHandle
from station.core.hardware.interfaces import JointGroup

FILTER = 0.005
"""Share of the distance to a new target that is covered per cycle."""
_DAMPING_OF_INVERSE = 0.2

RotationError = Callable[
    [NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]
]
"""Returns the error between the rotation matrix of the end effector, shape (3, 3), and
a desired quaternion, shape (4,), as a vector in the axes of the base, shape (3,)."""


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
        rotation_error: Returns the rotation error.
    """

    def __init__(
        self,
        joints: JointGroup,
        state: FrankaStateHandle,
        model: FrankaModelHandle,
        rotation_error: RotationError,
    ) -> None:
        self._joints = joints
        self._state = state
        self._model = model
        self._rotation_error = rotation_error
        self._position = self._target_position = np.zeros(3)
        self._rotation = self._target_rotation = np.array([1.0, 0.0, 0.0, 0.0])
        self._stiffness = np.zeros(6)
        self._damping = np.zeros(6)
        self._nullspace = 0.0
        self._rest = np.zeros(7)

    def pose(self) -> NDArray[np.float64]:
        """Return the measured pose O_T_EE, shape (4, 4)."""
        return np.reshape(self._state.get_robot_state().O_T_EE, (4, 4)).T

    def equilibrium(self) -> list[float]:
        """Return the equilibrium: position [m], then quaternion w x y z, shape (7,)."""
        return [*self._position.tolist(), *self._rotation.tolist()]

    def begin(self, nullspace: float) -> None:
        """Make the present pose the equilibrium, and start without stiffness.

        Args:
            nullspace: Stiffness of the null space from the start on [Nm/rad], >= 0.
        """
        pose = self.pose()
        self._position = pose[:3, 3].copy()
        self._rotation = quaternion_of(pose[:3, :3])
        self.set_target(self._position, self._rotation)
        self._stiffness = np.zeros(6)
        self._damping = np.zeros(6)
        self._nullspace = nullspace
        self._rest = np.array(self._state.get_robot_state().q)

    def set_target(
        self, position: NDArray[np.float64], rotation: NDArray[np.float64]
    ) -> None:
        """Set the equilibrium that is approached from now on.

        Args:
            position: In the base frame [m], shape (3,).
            rotation: Unit quaternion w x y z, shape (4,).
        """
        self._target_position = position
        self._target_rotation = rotation

    def update(self, stiffness: Stiffness) -> None:
        """Command the torques of this cycle, then move on towards the targets."""
        tau = self._torques()
        last = self._state.get_robot_state().tau_J_d
        self._joints.set_commands(saturate_torque_rate(tau, last))
        k, r = stiffness.translational, stiffness.rotational
        wanted = np.array([k, k, k, r, r, r])
        self._stiffness = _approach(self._stiffness, wanted)
        self._damping = _approach(self._damping, 2.0 * np.sqrt(wanted))
        self._nullspace += FILTER * (stiffness.nullspace - self._nullspace)
        self._position = _approach(self._position, self._target_position)
        self._rotation = slerp(self._rotation, self._target_rotation, FILTER)

    def _torques(self) -> NDArray[np.float64]:
        state, pose = self._state.get_robot_state(), self.pose()
        q, dq = np.array(state.q), np.array(state.dq)
        columns = self._model.get_zero_jacobian(Frame.END_EFFECTOR)
        jacobian = np.reshape(columns, (7, 6)).T
        error = np.concatenate([
            pose[:3, 3] - self._position,
            self._rotation_error(pose[:3, :3], self._rotation),
        ])
        wrench = -self._stiffness * error - self._damping * (jacobian @ dq)
        stray = self._nullspace * (self._rest - q) - 2.0 * sqrt(self._nullspace) * dq
        stray -= jacobian.T @ (_damped_inverse(jacobian.T) @ stray)
        coriolis = np.array(self._model.get_coriolis())
        result: NDArray[np.float64] = jacobian.T @ wrench + stray + coriolis
        return result


def _approach(
    value: NDArray[np.float64], target: NDArray[np.float64]
) -> NDArray[np.float64]:
    return value + FILTER * (target - value)


def _damped_inverse(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the pseudo-inverse with damped singular values s / (s^2 + 0.2^2)."""
    u, s, vt = np.linalg.svd(matrix, full_matrices=False)
    result: NDArray[np.float64] = (vt.T * (s / (s * s + _DAMPING_OF_INVERSE**2))) @ u.T
    return result
