"""Examples of torques and the model of an arm: follow a circle, press, read the model.

`JointImpedanceExampleController` draws a circle by pose commands. The arm's own inverse
kinematics turns the commanded pose into q_d and dq_d, and the controller follows them:

    tau = f c + K (q_d - q) + D (dq_d - dq_f)

with the Coriolis torques c, and the measured velocity dq_f after a low-pass filter.
`ForceExampleController` presses on a table with the weight of a mass:

    tau_d = J^T (0, 0, -9.81 m, 0, 0, 0)
    tau = tau_d + k_p (tau_d - tau_ext) + k_i integral(tau_d - tau_ext)

where tau_ext is the measured torque without gravity, minus its value at the start.

Source: franka_ros@c11f000 franka_example_controllers,
src/joint_impedance_example_controller.cpp, src/force_example_controller.cpp and
src/model_example_controller.cpp; differs: every start begins a new circle at rest, or
without force; an acceleration time of 0 is refused; the mass and the gains are run-time
parameters; the values of the model are kept for any thread to read instead of being
logged.
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
    ArmTorqueController,
    claim_torques,
    find_model,
    find_state,
    read_arm_id,
    read_arm_joints,
    saturate_torque_rate,
)
from station.core.control.controller import (
    PUBLISH_RATE,
    Controller,
    ControllerSample,
    MultiInterfaceController,
    require_interface,
)
from station.core.control.tunables import Tunable, Tunables
from station.core.declared_parameter import (
    DeclaredParameter,
    declare_number,
    declare_numbers,
)
from station.core.franka import (
    Frame,
    FrankaModelHandle,
    FrankaModelInterface,
    FrankaPoseCartesianInterface,
)
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
FILTER = 0.001
"""Share of the distance to a new mass or gain that is covered per cycle."""
GRAVITY = 9.81
"""Acceleration of gravity [m/s^2]."""
_FORCE_SCHEMA = {
    "desired_mass": Tunable("kg", 0.0, 2.0, "mass whose weight is pressed with"),
    "k_p": Tunable("", 0.0, 2.0),
    "k_i": Tunable("1/s", 0.0, 2.0),
}
RATE_HZ = 1.0
"""How often the model is evaluated."""


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


class ForceExampleController(ArmTorqueController):
    """Presses down; the end effector must touch a horizontal surface at the start.

    Parameters: `arm_id`; `joint_names`, 7 names.
    """

    @override
    def init(self, hw: RobotHW, params: Parameters) -> None:
        arm_id, self.joint_names = read_arm_id(params), read_arm_joints(params)
        self._joints = claim_torques(hw, self.joint_names)
        self._state = find_state(hw, arm_id)
        self._model = find_model(hw, arm_id)
        self._present = dict.fromkeys(_FORCE_SCHEMA, 0.0)
        self.tunables = Tunables(_FORCE_SCHEMA, self._present)
        self._bias = self._integral = np.zeros(7)

    @override
    def starting(self, time: float) -> None:
        """Make the present external torques the zero, and start without force."""
        measured = self._state.get_robot_state().tau_J
        self._bias = np.subtract(measured, self._model.get_gravity())
        self._integral = np.zeros(7)
        self._present = dict.fromkeys(_FORCE_SCHEMA, 0.0)

    @override
    def update(self, time: float, period: float) -> None:
        state, present = self._state.get_robot_state(), self._present
        columns = self._model.get_zero_jacobian(Frame.END_EFFECTOR)
        jacobian = np.reshape(columns, (7, 6)).T
        tau_ext = np.subtract(state.tau_J, self._model.get_gravity()) - self._bias
        tau_d = jacobian[2] * -GRAVITY * present["desired_mass"]
        error = tau_d - tau_ext
        self._integral = self._integral + period * error
        tau = tau_d + present["k_p"] * error + present["k_i"] * self._integral
        command = saturate_torque_rate(tau, state.tau_J_d)
        self._joints.set_commands(command)
        for name, value in self.tunables.values.items():
            present[name] += FILTER * (value - present[name])
        self.sample = ControllerSample(
            time, tau_d.tolist(), tau_ext.tolist(), error.tolist(), command
        )


@dataclass(frozen=True, slots=True)
class ModelSample:
    """One evaluation of the model; matrices are column-major.

    Attributes:
        stamp: Station time [s].
        mass: Mass matrix [kg m^2], shape (49,).
        coriolis: Coriolis torques [Nm], shape (7,).
        gravity: Gravity torques [Nm], shape (7,).
        pose: Pose of joint 4 in the base frame, shape (16,).
        body_jacobian: Body Jacobian of joint 4, shape (42,).
        zero_jacobian: Zero Jacobian of the end effector, shape (42,).
    """

    stamp: float
    mass: list[float]
    coriolis: list[float]
    gravity: list[float]
    pose: list[float]
    body_jacobian: list[float]
    zero_jacobian: list[float]


class ModelExampleController(Controller[FrankaModelInterface]):
    """Evaluates the model once a second; commands nothing.

    Parameters: `arm_id`.

    Attributes:
        model_sample: The last evaluation, a new object each time; None before that.
    """

    own_parameters = (ARM_ID,)

    @override
    def init(self, interface: FrankaModelInterface, params: Parameters) -> None:
        name = f"{read_arm_id(params)}_model"
        self._model: FrankaModelHandle = interface.get_handle(name)
        self._timer = PublishTimer(RATE_HZ)
        self.model_sample: ModelSample | None = None

    @override
    def starting(self, time: float) -> None:
        self._timer.start(time, at_once=True)

    @override
    def update(self, time: float, period: float) -> None:
        if not self._timer.is_due(time):
            return
        model = self._model
        self.model_sample = ModelSample(
            time,
            model.get_mass(),
            model.get_coriolis(),
            model.get_gravity(),
            model.get_pose(Frame.JOINT4),
            model.get_body_jacobian(Frame.JOINT4),
            model.get_zero_jacobian(Frame.END_EFFECTOR),
        )
