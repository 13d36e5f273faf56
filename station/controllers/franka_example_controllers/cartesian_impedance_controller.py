"""Hold the end effector with the stiffness of a spring, by torques.

    tau = J^T (-K e - D J dq) + (I - J^T (J^T)^+) (k (q_n - q) - 2 sqrt(k) dq) + c

Source: franka_ros@c11f000 franka_example_controllers,
src/cartesian_impedance_example_controller.cpp; differs: the equilibrium pose arrives as
a set-point of 7 numbers that may time out, the stiffnesses are gains.
"""

from collections.abc import Mapping
from math import sqrt
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from station.controllers.forward_command_controller.command_timeout import (
    read_command_timeout,
)
from station.controllers.forward_command_controller.watched_set_point import (
    WatchedSetPoint,
)
from station.controllers.franka_example_controllers.quaternion import (
    error_between,
    quaternion_of,
    slerp,
)
from station.controllers.franka_example_controllers.start_pose import (
    read_arm_id,
    read_joint_names,
)
from station.core.controller import MultiInterfaceController
from station.core.errors import InvalidCommandError
from station.core.interfaces import (
    EffortJointInterface,
    Frame,
    FrankaModelInterface,
    FrankaStateInterface,
    JointGroup,
)
from station.core.parameters import Parameters
from station.core.robot_hw import RobotHW
from station.core.set_point import SetPointElement, SetPointPort
from station.core.tunables import Tunable

FILTER = 0.005
"""Share of the way to a new target that is gone per cycle."""
LARGEST_STEP = 1.0
"""Of a torque per cycle [Nm]."""
_DAMPING_OF_INVERSE = 0.2
_DEFAULTS = {
    "translational_stiffness": 200.0,
    "rotational_stiffness": 10.0,
    "nullspace_stiffness": 0.5,
}
_SCHEMA = {
    "translational_stiffness": Tunable("N/m", 0.0, 400.0),
    "rotational_stiffness": Tunable("Nm/rad", 0.0, 30.0),
    "nullspace_stiffness": Tunable("Nm/rad", 0.0, 100.0),
}
_REACH = 2.0


class CartesianImpedanceExampleController(MultiInterfaceController):
    """A spring between the end effector and an equilibrium pose.

    Parameters: `arm_id`; `joint_names`, 7 names; `command_timeout` and
    `command_timeout_action`, see `TimeoutAction`. Set-point: position [m], then
    quaternion w x y z, of the end effector in the base frame. When it is no longer
    valid, the equilibrium stays where it has come to.
    """

    required_interfaces: ClassVar[tuple[type, ...]] = (
        EffortJointInterface,
        FrankaModelInterface,
        FrankaStateInterface,
    )

    @override
    def init(self, hw: RobotHW, params: Parameters) -> None:
        arm_id, names = read_arm_id(params), read_joint_names(params)
        efforts, models = hw.get(EffortJointInterface), hw.get(FrankaModelInterface)
        states = hw.get(FrankaStateInterface)
        if efforts is None or models is None or states is None:
            return  # refused before, by required_interfaces
        self._joints = JointGroup([efforts.get_handle(name) for name in names])
        self._model = models.get_handle(f"{arm_id}_model")
        self._state = states.get_handle(f"{arm_id}_robot")
        self.joint_names = names
        timeout, action = read_command_timeout(params)
        self.set_points = SetPointPort(
            [
                *(SetPointElement(axis, "m", -_REACH, _REACH) for axis in "xyz"),
                *(SetPointElement(f"q{part}", "", -1.0, 1.0) for part in "wxyz"),
            ],
            timeout=timeout,
        )
        self._watched = WatchedSetPoint(
            self.set_points, action, arm_id, self._equilibrium
        )
        self._followed: list[float] = []
        self._gains = dict(_DEFAULTS)
        self._position = self._target_position = np.zeros(3)
        self._rotation = self._target_rotation = np.array([1.0, 0.0, 0.0, 0.0])
        self._stiffness = np.zeros(6)
        self._damping = np.zeros(6)
        self._nullspace = 0.0
        self._rest = np.zeros(7)

    @override
    def starting(self, time: float) -> None:
        """Take the present pose as equilibrium; the spring begins without force."""
        state = self._state.get_robot_state()
        pose = np.reshape(state.O_T_EE, (4, 4)).T
        self._position = self._target_position = pose[:3, 3].copy()
        self._rotation = self._target_rotation = quaternion_of(pose[:3, :3])
        self._stiffness = np.zeros(6)
        self._damping = np.zeros(6)
        self._nullspace = self._gains["nullspace_stiffness"]
        self._rest = np.array(state.q)
        self._watched.begin()

    @override
    def update(self, time: float, period: float) -> None:
        state = self._state.get_robot_state()
        self._follow_targets()
        q, dq = np.array(state.q), np.array(state.dq)
        pose = np.reshape(state.O_T_EE, (4, 4)).T
        jacobian = np.reshape(
            self._model.get_zero_jacobian(Frame.END_EFFECTOR), (7, 6)
        ).T
        turned = error_between(quaternion_of(pose[:3, :3]), self._rotation)
        error = np.concatenate([
            pose[:3, 3] - self._position,
            -pose[:3, :3] @ turned,
        ])
        wrench = -self._stiffness * error - self._damping * (jacobian @ dq)
        stray = self._nullspace * (self._rest - q) - 2.0 * sqrt(self._nullspace) * dq
        stray -= jacobian.T @ (_damped_inverse(jacobian.T) @ stray)
        tau = jacobian.T @ wrench + stray + np.array(self._model.get_coriolis())
        last = np.array(state.tau_J_d)
        step = np.clip(tau - last, -LARGEST_STEP, LARGEST_STEP)
        self._joints.set_commands((last + step).tolist())

    @override
    def gain_schema(self) -> Mapping[str, Tunable]:
        return _SCHEMA

    @override
    def gains(self) -> dict[str, float]:
        return dict(self._gains)

    @override
    def apply_gains(self, values: Mapping[str, float]) -> None:
        self._gains = dict(values)

    def _equilibrium(self) -> list[float]:
        """Return where the equilibrium is, as a set-point."""
        return [*self._position.tolist(), *self._rotation.tolist()]

    def _follow_targets(self) -> None:
        command = self._watched.newest()
        if command is not self._followed:
            self._followed = command
            rotation = np.array(command[3:])
            length = float(np.linalg.norm(rotation))
            if length == 0.0:
                raise InvalidCommandError(
                    "the quaternion of the set-point is zero",
                    remedy="send one of unit length, w x y z",
                )
            self._target_position = np.array(command[:3])
            self._target_rotation = rotation / length
        gains = self._gains
        k, r = gains["translational_stiffness"], gains["rotational_stiffness"]
        stiffness = np.array([k, k, k, r, r, r])
        self._stiffness = _filtered(self._stiffness, stiffness)
        self._damping = _filtered(self._damping, 2.0 * np.sqrt(stiffness))
        self._nullspace += FILTER * (gains["nullspace_stiffness"] - self._nullspace)
        self._position = _filtered(self._position, self._target_position)
        self._rotation = slerp(self._rotation, self._target_rotation, FILTER)


def _filtered(
    value: NDArray[np.float64], target: NDArray[np.float64]
) -> NDArray[np.float64]:
    return value + FILTER * (target - value)


def _damped_inverse(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the pseudo-inverse with damped singular values."""
    u, s, vt = np.linalg.svd(matrix, full_matrices=False)
    result: NDArray[np.float64] = (vt.T * (s / (s * s + _DAMPING_OF_INVERSE**2))) @ u.T
    return result
