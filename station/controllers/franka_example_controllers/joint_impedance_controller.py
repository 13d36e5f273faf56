"""Draw a circle by pose commands, and follow it by torques of a joint impedance.

The arm's own inverse kinematics turns the commanded pose into q_d and dq_d. This
controller computes the torques that follow them:

    tau = f c + K (q_d - q) + D (dq_d - dq_f)

with the Coriolis torques c, and the measured velocity dq_f after a low-pass filter.

Source: franka_ros@c11f000 franka_example_controllers,
src/joint_impedance_example_controller.cpp; differs: every start begins a new circle at
rest, and an acceleration time of 0 is refused.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from math import cos, pi, sin
from typing import ClassVar

import numpy as np
from typing_extensions import override

from station.controllers.franka_arm import (
    ARM_ID,
    JOINT_NAMES,
    claim_torques,
    find_model,
    read_arm_id,
    read_arm_joints,
    saturate_torque_rate,
)
from station.core.control.controller import (
    PUBLISH_RATE,
    ControllerSample,
    MultiInterfaceController,
    require_interface,
)
from station.core.declared_parameter import (
    DeclaredParameter,
    declare_number,
    declare_numbers,
)
from station.core.franka import FrankaModelInterface, FrankaPoseCartesianInterface
from station.core.hardware.interfaces import EffortJointInterface
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters
from station.core.toolbox.publish_timer import PublishTimer

RADIUS = 0.1
"""Default of `radius`, which also replaces a radius that is too small [m]."""
SMALLEST_RADIUS = 0.005
"""Smallest radius of the circle [m]."""
NEW_SHARE = 0.99
"""Share of the new velocity in the filtered velocity."""
_DOF = 7


def _seven(name: str, unit: str, text: str) -> DeclaredParameter:
    return declare_numbers(name, text, unit=unit, size=_DOF)


_K_GAINS = _seven("k_gains", "Nm/rad", "stiffness of the seven joints")
_D_GAINS = _seven("d_gains", "Nms/rad", "damping of the seven joints")
_RADIUS = declare_number(
    "radius", "radius of the circle; replaces a radius below 0.005", RADIUS, "m"
)
_VEL_MAX = declare_number("vel_max", "speed along the circle", 0.05, "m/s")
_ACCELERATION_TIME = declare_number(
    "acceleration_time", "time in which that speed is reached", 2.0, "s"
)
_CORIOLIS = declare_number(
    "coriolis_factor", "factor of the compensated Coriolis torques", 1.0
)
_PUBLISH_RATE = replace(
    PUBLISH_RATE,
    default=30.0,
    description="rate at which `torque_comparison` is published",
)


@dataclass(frozen=True, slots=True)
class TorqueComparison:
    """Torques commanded in a cycle and measured in the next one.

    Attributes:
        tau_commanded: Commanded torques plus gravity torques [Nm], shape (7,).
        tau_measured: Measured torques [Nm], shape (7,).
        tau_error: Commanded minus measured torques [Nm], shape (7,).
        root_mean_square_error: Mean of the absolute errors [Nm]; the original computes
            the mean under this name.
    """

    tau_commanded: list[float]
    tau_measured: list[float]
    tau_error: list[float]
    root_mean_square_error: float


class JointImpedanceExampleController(MultiInterfaceController):
    """Follows the joint motion of a Cartesian circle by torques.

    Parameters: `arm_id`; `joint_names`, 7 names; `k_gains` [Nm/rad] and `d_gains`
    [Nms/rad], 7 numbers each; `radius` [m]; `vel_max` along the circle [m/s], reached
    after `acceleration_time` [s]; `coriolis_factor`; `publish_rate` of
    `torque_comparison` [Hz].
    """

    required_interfaces: ClassVar[tuple[type, ...]] = (
        EffortJointInterface,
        FrankaModelInterface,
        FrankaPoseCartesianInterface,
    )
    own_parameters = (
        ARM_ID,
        JOINT_NAMES,
        _K_GAINS,
        _D_GAINS,
        _RADIUS,
        _VEL_MAX,
        _ACCELERATION_TIME,
        _CORIOLIS,
        _PUBLISH_RATE,
    )

    @override
    def init(self, hw: RobotHW, params: Parameters) -> None:
        arm_id, self.joint_names = read_arm_id(params), read_arm_joints(params)
        radius = _RADIUS.read_float(params)
        self._radius = RADIUS if abs(radius) < SMALLEST_RADIUS else radius
        self._vel_max = _VEL_MAX.read_float(params)
        self._acceleration_time = _ACCELERATION_TIME.read_float(params)
        if self._acceleration_time == 0.0:
            _ACCELERATION_TIME.refuse(params, "0 s", "another time")
        self._k = np.array(_K_GAINS.read_float_list(params))
        self._d = np.array(_D_GAINS.read_float_list(params))
        self._coriolis_factor = _CORIOLIS.read_float(params)
        self._timer = PublishTimer(_PUBLISH_RATE.read_float(params))
        self._joints = claim_torques(hw, self.joint_names)
        self._model = find_model(hw, arm_id)
        poses = require_interface(hw, FrankaPoseCartesianInterface)
        self._pose = poses.get_handle(f"{arm_id}_robot")
        self._initial_pose: list[float] = []
        self._angle = self._velocity = 0.0
        self._filtered_dq = self._last_tau = np.zeros(_DOF)
        self._comparison: TorqueComparison | None = None

    @override
    def starting(self, time: float) -> None:
        """Start a circle at the desired pose of the end effector."""
        state = self._pose.get_robot_state()
        self._initial_pose = list(state.O_T_EE_d)
        self._pose.set_command(self._initial_pose)
        self._angle = self._velocity = 0.0
        self._filtered_dq = np.zeros(_DOF)
        self._last_tau = np.array(state.tau_J)
        self._timer.start(time, at_once=False)

    @override
    def update(self, time: float, period: float) -> None:
        self._pose.set_command(self._next_pose(period))
        state = self._pose.get_robot_state()
        error = np.subtract(state.q_d, state.q)
        self._filtered_dq = (1.0 - NEW_SHARE) * self._filtered_dq
        self._filtered_dq += NEW_SHARE * np.array(state.dq)
        tau = self._k * error + self._d * (np.array(state.dq_d) - self._filtered_dq)
        tau += self._coriolis_factor * np.array(self._model.get_coriolis())
        command = saturate_torque_rate(tau, state.tau_J_d)
        self._joints.set_commands(command)
        if self._timer.is_due(time):
            self._comparison = _compare(self._last_tau.tolist(), state.tau_J)
        self._last_tau = np.add(command, self._model.get_gravity())
        self.sample = ControllerSample(
            time, list(state.q_d), list(state.q), error.tolist(), command
        )

    @override
    def published(self) -> Mapping[str, Mapping[str, object]]:
        found = self._comparison
        return {} if found is None else {"torque_comparison": asdict(found)}

    def _next_pose(self, period: float) -> list[float]:
        if self._velocity < self._vel_max:
            self._velocity += period * abs(self._vel_max / self._acceleration_time)
        self._velocity = min(self._velocity, self._vel_max)
        self._angle += period * self._velocity / abs(self._radius)
        if self._angle > 2.0 * pi:
            self._angle -= 2.0 * pi
        pose = list(self._initial_pose)
        pose[13] += self._radius * (1.0 - cos(self._angle))
        pose[14] += self._radius * sin(self._angle)
        return pose


def _compare(commanded: list[float], measured: list[float]) -> TorqueComparison:
    error = [a - b for a, b in zip(commanded, measured, strict=True)]
    mean = sum(map(abs, error)) / _DOF
    return TorqueComparison(commanded, list(measured), error, mean)
