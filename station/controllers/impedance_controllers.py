"""Impedance controllers of Franka arms: springs and dampers for everyday use.

The laws are `PoseImpedance` and `JointImpedance` of `franka_arm.impedances`. The first
differs from the example controller of franka_ros: a stiffness for each axis, of which
the null space takes nothing away; damping by the ratio and the arm's inertia; bounded
forces of the spring; compensation of friction.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from station.controllers.franka_arm import (
    LARGEST_STEP,
    ArmTorqueController,
    claim_torques,
    find_model,
    find_state,
    read_arm_id,
    read_arm_joints,
)
from station.controllers.franka_arm.cartesian_spring import CartesianSpring
from station.controllers.franka_arm.impedances import (
    Friction,
    JointImpedance,
    PoseImpedance,
)
from station.controllers.franka_arm.pose_target import PoseTarget
from station.core.control.controller import ControllerSample
from station.core.control.tunables import Tunable, Tunables
from station.core.declared_parameter import (
    DeclaredParameter,
    ParameterType,
    declare_number,
    declare_numbers,
)
from station.core.description.robot_description import require_robot_description
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters
from station.core.ports.set_point import (
    ActiveSetPoint,
    SetPointElement,
    SetPointPort,
    read_command_timeout,
    timeout_parameters,
)
from station.memory.doubles import Doubles, doubles, put

DESIGN_INTERVAL = 10
"""Cycles after which the damping is designed anew: the arm's inertia changes slowly."""
_AXES = ("x", "y", "z", "rx", "ry", "rz")


@dataclass(frozen=True, slots=True)
class Setting:
    """A parameter that gives the first value of a run-time parameter of its name."""

    name: str
    unit: str
    default: float
    maximum: float
    description: str

    def parameter(self) -> DeclaredParameter:
        """Return the parameter, which may be larger than a slider allows."""
        return declare_number(
            self.name, self.description, self.default, self.unit, minimum=0.0
        )

    def tunable(self, value: float) -> Tunable:
        """Return the run-time parameter; the range includes the configured value."""
        tunable = Tunable(self.unit, 0.0, self.maximum, self.description)
        return tunable.including(value)


DAMPING_RATIO = Setting(
    "damping_ratio", "", 1.0, 2.0, "damping; 1: no motion overshoots"
)
FRICTION_SHARE = Setting(
    "friction_compensation", "", 0.0, 1.0, "share of the friction that is compensated"
)


def _coefficients(
    name: str, unit: str, default: tuple[float, ...], text: str
) -> DeclaredParameter:
    return declare_numbers(name, text, default, unit, size=7, default_text="of a Panda")


FRICTION = (
    _coefficients(
        "friction/fp1",
        "Nm",
        (0.54615, 0.87224, 0.64068, 1.2794, 0.83904, 0.30301, 0.56489),
        "friction of the joints at high speed, forwards plus backwards",
    ),
    _coefficients(
        "friction/fp2",
        "s/rad",
        (5.1181, 9.0657, 10.136, 5.5903, 8.3469, 17.133, 10.336),
        "how suddenly the friction rises with the speed",
    ),
    _coefficients(
        "friction/fp3",
        "rad/s",
        (0.03953, 0.02588, -0.04607, 0.03619, 0.02623, -0.02105, 0.00355),
        "velocity that makes the friction larger one way than the other",
    ),
)
"""The coefficients phi_1, phi_2 and phi_3 of Gaz et al., see `impedances`."""


def read_friction(params: Parameters, dq: Doubles) -> Friction:
    """Return the compensation of friction that the parameters describe, off at first.

    Args:
        params: The controller's namespace.
        dq: Measured joint velocities [rad/s], shape (7,).

    Raises:
        ParameterError: A coefficient is not a list of 7 numbers.
    """
    height, slope, shift = (doubles(each.read_float_list(params)) for each in FRICTION)
    return Friction(dq, height, slope, shift)


def read_settings(
    settings: Sequence[Setting], params: Parameters
) -> tuple[dict[str, Tunable], dict[str, float]]:
    """Return schema and values of run-time parameters, as the parameters have them.

    Raises:
        ParameterError: A parameter is not a number, or negative.
    """
    values = {each.name: each.parameter().read_float(params) for each in settings}
    return {each.name: each.tunable(values[each.name]) for each in settings}, values


def square(flat: Sequence[float]) -> NDArray[np.float64]:
    """Return a symmetric matrix of n n numbers, shape (n, n)."""
    size = round(len(flat) ** 0.5)
    return np.array(flat).reshape(size, size)


def damping_matrix(
    inertia: NDArray[np.floating], stiffness: Sequence[float], ratio: float
) -> NDArray[np.float64]:
    """Return the D of M ddx + D dx + K x = 0 whose motions all have one damping ratio.

    With M = L L^T and the eigenvalues w^2 of L^-1 K L^-T = V w^2 V^T it is
    D = 2 ratio L V w V^T L^T.

    Args:
        inertia: The matrix M, symmetric and positive definite, shape (n, n).
        stiffness: The diagonal of K, shape (n,), >= 0.
        ratio: The damping ratio, >= 0; 1 is critical damping.

    Returns:
        The matrix D, shape (n, n).

    Source:
        A. Albu-Schäffer, C. Ott, U. Frese, G. Hirzinger: Cartesian impedance control
        of redundant robots, ICRA 2003, the double diagonalization design.
    """
    lower = np.linalg.cholesky(inertia)
    inverse = np.linalg.inv(lower)
    squares, vectors = np.linalg.eigh((inverse * np.asarray(stiffness)) @ inverse.T)
    # Rounding makes the square of a frequency of 0 negative.
    frequencies = np.sqrt(np.maximum(squares, 0.0))
    shape = lower @ vectors
    damping: NDArray[np.float64] = (2.0 * ratio * shape * frequencies) @ shape.T
    return damping


_POSE_SETTINGS = (
    *(
        Setting(f"stiffness/{axis}", "N/m", 400.0, 3000.0, f"stiffness along {axis}")
        for axis in _AXES[:3]
    ),
    *(
        Setting(
            f"stiffness/{axis}", "Nm/rad", 30.0, 300.0, f"stiffness about {axis[1]}"
        )
        for axis in _AXES[3:]
    ),
    DAMPING_RATIO,
    Setting(
        "nullspace/stiffness", "Nm/rad", 10.0, 100.0, "stiffness towards the posture"
    ),
    Setting("nullspace/damping_ratio", "", 1.0, 2.0, "damping of the null space"),
    Setting("max_force", "N", 100.0, 150.0, "largest force of the spring"),
    Setting("max_torque", "Nm", 20.0, 50.0, "largest torque of the spring"),
    FRICTION_SHARE,
)
_POSTURE = declare_numbers(
    "posture",
    "joint positions that the null space approaches",
    unit="rad",
    size=7,
    default_text="where the arm is at the start",
)
_TURN = 6.3
"""Largest position of a posture [rad]; no joint of an arm goes farther."""
# Makes the inertia of a direction in which the arm cannot move finite: 1 / 1e-4 kg.
_INVERSE_INERTIA = 1e-4 * np.eye(6)
_JOINT_SETTINGS = (DAMPING_RATIO, FRICTION_SHARE)
_STIFFNESS = DeclaredParameter(
    name="stiffness",
    type=ParameterType.NUMBER_OR_NUMBERS,
    unit="Nm/rad",
    default=(600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0),
    default_text="600, for the last joints 250, 150, 50",
    minimum=0.0,
    description="stiffness of the joints; one number, or seven",
)
_LARGEST_STIFFNESS = 2000.0


class CartesianImpedanceController(ArmTorqueController):
    """A spring and a damper between the end effector and an equilibrium pose.

    Set-point: position [m], then quaternion w x y z, of the end effector in the base
    frame. When it expires, the equilibrium stays where it is then. A start takes the
    present pose for the equilibrium, and the stiffness rises from 0.

    All parameters but the arm, its joints, `posture` and the coefficients of friction
    are run-time parameters as well, and so is `<joint>/posture`.
    """

    own_parameters = (
        *timeout_parameters(),
        *(each.parameter() for each in _POSE_SETTINGS),
        _POSTURE,
        *FRICTION,
    )

    @override
    def init(self, hw: RobotHW, params: Parameters) -> None:
        arm_id, names = read_arm_id(params), read_arm_joints(params)
        state = find_state(hw, arm_id)
        self._model = find_model(hw, arm_id)
        self._spring = CartesianSpring(
            claim_torques(hw, names),
            state,
            self._model,
            is_angle=True,
            law=PoseImpedance,
        )
        self._law = cast("PoseImpedance", self._spring.spring)
        arm = state.get_robot_state()
        self._q, self._time = arm.doubles("q"), 0.0
        self._law.friction = read_friction(params, arm.doubles("dq"))
        self.joint_names = names
        self._target = PoseTarget(params, arm_id, self._spring.equilibrium)
        self.set_points = self._target.port
        self._update = self._target.follow(self._spring)
        self._cycle = 0
        schema, values = read_settings(_POSE_SETTINGS, params)
        self._starts_posture = not params.has(_POSTURE.name)
        posture = [*self._q]
        if not self._starts_posture:
            posture = _POSTURE.read_float_list(params)
        for k, name in enumerate(names):
            # A posture of the start belongs to that start, not to the parameters.
            parameter = "" if self._starts_posture else f"{_POSTURE.name}[{k}]"
            schema[f"{name}/posture"] = Tunable(
                "rad", -_TURN, _TURN, _POSTURE.description, parameter=parameter
            )
        self.tunables = Tunables(
            schema, values | self._named(posture), apply=self._apply
        )

    @override
    def starting(self, time: float) -> None:
        """Make the present pose the equilibrium, at which the spring has no force."""
        if self._starts_posture:
            self.tunables.values = {**self.tunables.values, **self._named(self._q)}
        values = self.tunables.values
        self._spring.start_at_rest(values["nullspace/stiffness"])
        self._apply(values)
        self._target.start_at_rest()
        self._cycle = 0

    @override
    def update(self, time: float, period: float) -> None:
        if self._cycle % DESIGN_INTERVAL == 0:
            self._design()
        self._cycle += 1
        self._time = time
        self._update.command_springs(time)

    @override
    def published(self) -> Mapping[str, Mapping[str, object]]:
        """Return the topic `state`: error, stiffness and torques of the last cycle."""
        if self._cycle == 0:
            return {}
        law = self._law
        message: dict[str, object] = {
            "stamp": self._time,
            "error": [*law.error],
            "stiffness": [*law.axes],
            "torques": [*law.torques],
        }
        return {"state": message}

    def _named(self, posture: Iterable[float]) -> dict[str, float]:
        return {
            f"{name}/posture": value
            for name, value in zip(self.joint_names, posture, strict=True)
        }

    def _apply(self, values: Mapping[str, float]) -> None:
        law = self._law
        put(law.wanted_axes, [values[f"stiffness/{axis}"] for axis in _AXES])
        put(law.posture, [values[f"{name}/posture"] for name in self.joint_names])
        # The null space's stiffness is filtered with those of the other springs.
        put(law.wanted, (0.0, 0.0, values["nullspace/stiffness"]))
        law.largest_force = values["max_force"]
        law.largest_torque = values["max_torque"]
        if law.friction is not None:
            law.friction.share = values["friction_compensation"]

    def _design(self) -> None:
        """Bring the damping up to date with the arm's inertia and the stiffness."""
        values, law = self.tunables.values, self._law
        mass = square(self._model.get_mass())
        jacobian = np.array(law.jacobian).reshape(-1, 6).T
        inertia = np.linalg.inv(
            jacobian @ np.linalg.solve(mass, jacobian.T) + _INVERSE_INERTIA
        )
        damping = damping_matrix(inertia, law.axes, values["damping_ratio"])
        put(law.dampings, damping.ravel())
        # As if every joint had the mean inertia of them all.
        mean = float(mass.trace()) / len(mass)
        critical = 2.0 * (law.stiffness[2] * mean) ** 0.5
        law.slowing = values["nullspace/damping_ratio"] * critical


class JointImpedanceController(ArmTorqueController):
    """A spring and a damper between every joint and its equilibrium position.

    Set-point: positions of the seven joints [rad]; when it expires, the joints are held
    where they are then. A start takes the present positions for the equilibrium, and
    the stiffness rises from 0.

    Run-time parameters: `damping_ratio`, `friction_compensation`, and
    `<joint>/stiffness` with the parameter `stiffness` as first values.
    """

    own_parameters = (
        *timeout_parameters(),
        _STIFFNESS,
        *(each.parameter() for each in _JOINT_SETTINGS),
        *FRICTION,
    )

    @override
    def init(self, hw: RobotHW, params: Parameters) -> None:
        arm_id, self.joint_names = read_arm_id(params), read_arm_joints(params)
        state = find_state(hw, arm_id).get_robot_state()
        self._model = find_model(hw, arm_id)
        self._coriolis = self._model.coriolis_source()
        self._joints = claim_torques(hw, self.joint_names)
        self._q = state.doubles("q")
        self._friction = read_friction(params, state.doubles("dq"))
        self._law = JointImpedance(
            self._q,
            state.doubles("dq"),
            state.doubles("tau_J_d"),
            LARGEST_STEP,
            self._friction,
        )
        timeout, action = read_command_timeout(params)
        description = require_robot_description(params)
        joints = [description.joint(name) for name in self.joint_names]
        self.set_points = SetPointPort(
            [SetPointElement(j.name, "rad", j.lower, j.upper) for j in joints],
            timeout=timeout,
        )
        self._active = ActiveSetPoint(
            self.set_points, action, arm_id, lambda: [*self._q]
        )
        self._cycle = 0
        schema, values = read_settings(_JOINT_SETTINGS, params)
        for k, stiffness in enumerate(_STIFFNESS.read_per_axis(params)):
            name = f"{self.joint_names[k]}/stiffness"
            schema[name] = Tunable(
                "Nm/rad",
                0.0,
                max(_LARGEST_STIFFNESS, stiffness),
                "stiffness of the joint",
                parameter=f"{_STIFFNESS.name}[{k}]",
            )
            values[name] = stiffness
        self.tunables = Tunables(schema, values, apply=self._apply)

    @override
    def starting(self, time: float) -> None:
        self._law.start_at_rest()
        self._apply(self.tunables.values)
        self._active.start_at_rest()
        self._cycle = 0

    @override
    def update(self, time: float, period: float) -> None:
        law = self._law
        if self._cycle % DESIGN_INTERVAL == 0:
            ratio = self.tunables.values["damping_ratio"]
            mass = square(self._model.get_mass())
            put(law.dampings, damping_matrix(mass, law.stiffness, ratio).ravel())
        self._cycle += 1
        if self._active.port.has_changed():
            put(law.target, self._active.newest())
        self._coriolis.write(law.coriolis)
        law.compute_torques()
        torques = [*law.torques]
        self._joints.set_commands(torques)
        self.sample = ControllerSample(
            time, [*law.desired], [*self._q], [*law.errors], torques
        )

    def _apply(self, values: Mapping[str, float]) -> None:
        put(
            self._law.wanted,
            [values[f"{name}/stiffness"] for name in self.joint_names],
        )
        self._friction.share = values["friction_compensation"]
