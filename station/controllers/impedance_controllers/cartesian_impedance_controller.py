"""Hold the end effector of an arm by a spring and a damper, by torques.

The law is that of `franka_arm.impedances.PoseImpedance`. It differs from the example
controller of franka_ros: a stiffness for each axis, of which the null space takes
nothing away; damping by the ratio and the arm's inertia; bounded forces of the spring;
compensation of friction.
"""

from collections.abc import Iterable, Mapping
from typing import cast

import numpy as np
from typing_extensions import override

from station.controllers.franka_arm import (
    ArmTorqueController,
    claim_torques,
    find_model,
    find_state,
    read_arm_id,
    read_arm_joints,
)
from station.controllers.franka_arm.cartesian_spring import (
    CartesianSpring,
)
from station.controllers.franka_arm.impedances import PoseImpedance
from station.controllers.franka_arm.pose_target import PoseTarget
from station.controllers.impedance_controllers.impedance_settings import (
    DAMPING_RATIO,
    DESIGN_INTERVAL,
    FRICTION,
    FRICTION_SHARE,
    Setting,
    damping_matrix,
    read_friction,
    read_settings,
    square,
)
from station.core.control.tunables import Tunable, Tunables
from station.core.declared_parameter import declare_numbers
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters
from station.core.ports.set_point import timeout_parameters
from station.memory.doubles import put

_AXES = ("x", "y", "z", "rx", "ry", "rz")
_SETTINGS = (
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
        *(each.parameter() for each in _SETTINGS),
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
        schema, values = read_settings(_SETTINGS, params)
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
