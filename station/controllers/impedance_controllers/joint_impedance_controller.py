"""Hold the joints of an arm by springs and dampers, by torques.

The law is that of `franka_arm.impedances.JointImpedance`.
"""

from collections.abc import Mapping

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
from station.controllers.franka_arm.impedances import JointImpedance
from station.controllers.impedance_controllers.impedance_settings import (
    DAMPING_RATIO,
    DESIGN_INTERVAL,
    FRICTION,
    FRICTION_SHARE,
    damping_matrix,
    read_friction,
    read_settings,
    square,
)
from station.core.control.controller import ControllerSample
from station.core.control.tunables import Tunable, Tunables
from station.core.declared_parameter import DeclaredParameter, ParameterType
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
from station.memory.doubles import put

_SETTINGS = (DAMPING_RATIO, FRICTION_SHARE)
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
        *(each.parameter() for each in _SETTINGS),
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
        schema, values = read_settings(_SETTINGS, params)
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
