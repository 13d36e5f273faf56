"""Let an arm whose joints are controlled give way to forces at its sensor.

Source: ros2_controllers@6.x admittance_controller/src/admittance_controller.cpp,
admittance_controller_parameters.yaml.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import inf, isfinite, sqrt
from typing import ClassVar

from typing_extensions import override

from station.controllers.admittance_controller.admittance_rule import AdmittanceRule
from station.controllers.joint_references import JointReferenceController
from station.controllers.set_point_controller import (
    JOINTS,
    ControlledJoints,
    JointQuantity,
    read_joint_names,
)
from station.core.control.controller import ControllerSample
from station.core.control.tunables import Tunable, Tunables
from station.core.declared_parameter import (
    DeclaredParameter,
    NameKind,
    declare_number,
    declare_numbers,
    declare_string,
    declare_strings,
)
from station.core.description.robot_description import (
    ROBOT_DESCRIPTION,
    chain_to,
    require_robot_description,
)
from station.core.description.urdf_parser import parse_urdf
from station.core.errors import ControllerLoadError
from station.core.hardware.interfaces import (
    ForceTorqueSensorInterface,
    JointGroup,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.robot_hw import RobotHW
from station.core.numerics.arm_chain import JointChain
from station.core.parameters import Parameters
from station.core.ports.set_point import (
    timeout_parameters,
)
from station.memory.doubles import doubles, put, zeros

_AXES = ("x", "y", "z", "rx", "ry", "rz")


def _numbers(
    name: str, text: str, size: int, least: float, most: float = inf
) -> DeclaredParameter:
    return declare_numbers(name, text, size=size, minimum=least, maximum=most)


def _number(
    name: str, text: str, default: float, unit: str = "", most: float = inf
) -> DeclaredParameter:
    return declare_number(name, text, default, unit, minimum=0.0, maximum=most)


_COMMAND_JOINTS = declare_strings(
    "command_joints",
    "what is commanded: joints, or references `controller/joint`",
    names=NameKind.JOINT,
    default_text="joints",
)
_COMMANDS = declare_strings(
    "command_interfaces", "what is commanded: `position` or `velocity`"
)
_REFERENCES = declare_strings(
    "chainable_command_interfaces",
    "the references: `position`, or `position` and `velocity`",
    ("position", "velocity"),
)
_BASE = declare_string("kinematics/base", "the link that carries the arm")
_TIP = declare_string("kinematics/tip", "the link at the end of the arm")
_ALPHA = _number("kinematics/alpha", "damping of the inverse of the Jacobian", 0.01)
_SENSOR = declare_string("ft_sensor/name", "the force-torque sensor")
_SENSOR_FRAME = declare_string(
    "ft_sensor/frame/id", "the link in whose frame it measures"
)
_SMOOTHING = _number(
    "ft_sensor/filter_coefficient",
    "share of a new measurement in the force",
    0.05,
    most=1.0,
)
_CONTROL_FRAME = declare_string("control/frame/id", "the link whose axes the rule has")
_WORLD_FRAME = declare_string(
    "fixed_world_frame/frame/id", "a link whose z axis points upwards"
)
_CENTRE_FRAME = declare_string(
    "gravity_compensation/frame/id", "the link in whose frame the centre of gravity is"
)
_CENTRE = declare_numbers(
    "gravity_compensation/CoG/pos",
    "centre of gravity of what the sensor carries",
    unit="m",
    size=3,
)
_WEIGHT = _number(
    "gravity_compensation/CoG/force", "weight of what the sensor carries", 0.0, "N"
)
_SELECTED = declare_numbers(
    "admittance/selected_axes", "which axes give way, x y z rx ry rz: booleans"
)
_MASS = _numbers("admittance/mass", "masses [kg, kg m^2]", 6, 1e-4, 1e6)
_RATIO = _numbers("admittance/damping_ratio", "damping ratios", 6, 0.0)
_STIFFNESS = _numbers("admittance/stiffness", "stiffnesses [N/m, Nm/rad]", 6, 0.0, 1e8)
_JOINT_DAMPING = _number(
    "admittance/joint_damping", "damping of the joints' way", 5.0, "1/s"
)
_TUNED = {
    "mass": Tunable("kg, kg m^2", 1e-4, 1000.0, "mass"),
    "damping_ratio": Tunable("", 0.0, 10.0, "damping ratio"),
    "stiffness": Tunable("N/m, Nm/rad", 0.0, 10_000.0, "stiffness"),
    "selected_axes": Tunable("", 0.0, 1.0, "1: the axis gives way to a force"),
}


class AdmittanceController(JointReferenceController):
    """Moves joints from their references as a force moves a mass on a spring.

    The references `<joint>/position` and `<joint>/velocity` come from a preceding
    controller, or from set-points. `admittance_rule` has the formulas.

    Source:
        AdmittanceController; differs: one interface is commanded, because a joint
        follows one; the plug-in of kinematics is the station's own; the fixed world
        frame is fixed to the base.
    """

    required_interfaces: ClassVar[tuple[type, ...]] = (ForceTorqueSensorInterface,)
    optional_interfaces: ClassVar[tuple[type, ...]] = (
        PositionJointInterface,
        VelocityJointInterface,
    )
    accepted_parameters: ClassVar[tuple[str, ...]] = (
        "state_interfaces",
        "kinematics/plugin_name",
        "kinematics/plugin_package",
        "enable_parameter_update_without_reactivation",
        "robot_description",
        "robot_base_frame",
        "state_publish_rate",
    )
    own_parameters = (
        *timeout_parameters(),
        JOINTS,
        _COMMAND_JOINTS,
        _COMMANDS,
        _REFERENCES,
        _BASE,
        _TIP,
        _ALPHA,
        _SENSOR,
        _SENSOR_FRAME,
        _SMOOTHING,
        _CONTROL_FRAME,
        _WORLD_FRAME,
        _CENTRE_FRAME,
        _CENTRE,
        _WEIGHT,
        _SELECTED,
        _MASS,
        _RATIO,
        _STIFFNESS,
        _JOINT_DAMPING,
    )

    @override
    def init(self, hw: RobotHW, params: Parameters) -> None:
        self.joint_names = read_joint_names(params)
        sensors: ForceTorqueSensorInterface | None = hw.get(ForceTorqueSensorInterface)
        commanded = _COMMANDS.read_str_list(params)
        kinds = {"position": PositionJointInterface, "velocity": VelocityJointInterface}
        if len(commanded) != 1 or commanded[0] not in kinds:
            _COMMANDS.refuse(params, commanded, "[position] or [velocity]")
        self._commands_positions = commanded == ["position"]
        joints = hw.get(kinds[commanded[0]])
        # There are sensors: the manager has looked. It is for the type checker.
        if joints is None or sensors is None:
            raise ControllerLoadError(
                f"The robot has no joints that take a {commanded[0]}.",
                remedy="Choose another of the `command_interfaces`.",
            )
        self._sensor = sensors.get_handle(_SENSOR.read_str(params))
        names = _COMMAND_JOINTS.read_str_list(params, []) or self.joint_names
        if len(names) != len(self.joint_names):
            _COMMAND_JOINTS.refuse(params, names, "one name for each of the `joints`")
        self._handles = [joints.get_handle(name) for name in names]
        self._joints = ControlledJoints(JointGroup(self._handles))
        self._make_rule(params)
        self._make_references(params)
        self._read_tunables(params)

    @override
    def rest(self, n: int) -> list[float]:
        return [0.0] * len(self.joint_names) if n else [*self._joints.positions]

    @override
    def rest_reader(self, n: int, k: int) -> Callable[[], float]:
        # The copy of the positions is old while the controller does not run.
        return super().rest_reader(n, k) if n else self._handles[k].get_position

    @override
    def starting(self, time: float) -> None:
        self._joints.read()
        self._rule.reset()
        self._last = doubles(self._joints.positions)
        super().starting(time)

    @override
    def update_and_write_commands(self, time: float, period: float) -> None:
        rule, joints = self._rule, self._joints
        q_ref, dq_ref = self.references
        joints.read()
        # As in the original, what a sensor does not tell is what was commanded, or 0.
        is_known = all(isfinite(each) for each in joints.positions)
        wrench = self._sensor.get_force() + self._sensor.get_torque()
        if self._sensor.is_reaction:
            wrench = [-value for value in wrench]
        put(rule.wrench, wrench if all(map(isfinite, wrench)) else [0.0] * 6)
        rule.compute_motion(joints.positions if is_known else self._last, q_ref, period)
        put(self._last, [a + b for a, b in zip(q_ref, rule.positions, strict=True)])
        references, way = q_ref, rule.positions
        if not self._commands_positions:
            references, way = dq_ref, rule.velocities
        commands = [a + b for a, b in zip(references, way, strict=True)]
        put(joints.commands, commands)
        joints.write()
        self.sample = ControllerSample(
            time, [*q_ref], [*joints.positions], [*rule.positions], commands
        )

    @override
    def published(self) -> Mapping[str, Mapping[str, object]]:
        """Return the topic `state`: force, way and velocity in the axes of the base.

        Source:
            control_msgs@5.x msg/AdmittanceControllerState.msg.
        """
        if self.sample is None:
            return {}
        rule = self._rule
        message: dict[str, object] = {
            "stamp": self.sample.stamp,
            "wrench_base": [*rule.force],
            "admittance_position": [*rule.error],
            "admittance_velocity": [*rule.velocity],
            "joint_positions": [*rule.positions],
            "joint_velocities": [*rule.velocities],
            "joint_accelerations": [*rule.accelerations],
        }
        return {"state": message}

    def _make_rule(self, params: Parameters) -> None:
        urdf = parse_urdf(str(params.tree.get(ROBOT_DESCRIPTION)))
        base, names = _BASE.read_str(params), self.joint_names

        def chain(frame: DeclaredParameter) -> JointChain:
            return chain_to(urdf, base, frame.read_str(params), names)

        chain(_TIP)
        self._rule = rule = AdmittanceRule(
            len(names),
            chain(_SENSOR_FRAME),
            chain(_SENSOR_FRAME),
            chain(_CONTROL_FRAME),
            chain(_CENTRE_FRAME),
        )
        world = chain(_WORLD_FRAME)
        if world.count:
            _WORLD_FRAME.refuse(
                params, _WORLD_FRAME.read_str(params), "a link fixed to the base"
            )
        world.place(zeros(len(names)))
        self._upwards = doubles(world.pose[8:11])
        rule.inverse_damping = _ALPHA.read_float(params)
        rule.smoothing = _SMOOTHING.read_float(params)
        put(rule.centre_of_gravity, _CENTRE.read_float_list(params))

    def _make_references(self, params: Parameters) -> None:
        kinds = _REFERENCES.read_str_list(params)
        if kinds not in (["position"], ["position", "velocity"]):
            _REFERENCES.refuse(params, kinds, "[position] or [position, velocity]")
        description = require_robot_description(params)
        joints = [description.joint(name) for name in self.joint_names]
        quantities = (JointQuantity.POSITION, JointQuantity.VELOCITY)
        self.make_references(params, joints, quantities)
        self.exported_quantities = len(kinds)

    def _read_tunables(self, params: Parameters) -> None:
        lists = {
            "mass": _MASS.read_float_list(params),
            "damping_ratio": _RATIO.read_float_list(params),
            "stiffness": _STIFFNESS.read_float_list(params),
            "selected_axes": _read_selected(params),
        }
        schema, values = {}, {}
        for key, numbers in lists.items():
            for k, (axis, value) in enumerate(zip(_AXES, numbers, strict=True)):
                tunable = _TUNED[key].including(value)
                parameter = f"admittance/{key}[{k}]"
                schema[f"{key}/{axis}"] = replace(tunable, parameter=parameter)
                values[f"{key}/{axis}"] = value
        for name, declared, most in (
            ("joint_damping", _JOINT_DAMPING, 100.0),
            ("tool_weight", _WEIGHT, 200.0),
        ):
            value = declared.read_float(params)
            tunable = Tunable(
                declared.unit,
                0.0,
                most,
                declared.description,
                parameter=declared.name,
            )
            schema[name] = tunable.including(value)
            values[name] = value
        self.tunables = Tunables(schema, values, apply=self._apply)
        self._apply(values)

    def _apply(self, values: Mapping[str, float]) -> None:
        rule = self._rule
        for k, axis in enumerate(_AXES):
            mass, stiffness = values[f"mass/{axis}"], values[f"stiffness/{axis}"]
            rule.inverse_mass[k] = 1.0 / mass
            rule.stiffness[k] = stiffness
            ratio = values[f"damping_ratio/{axis}"]
            rule.damping[k] = 2.0 * ratio * sqrt(mass * stiffness)
            rule.selected[k] = values[f"selected_axes/{axis}"]
        rule.joint_damping = values["joint_damping"]
        put(rule.weight, [-values["tool_weight"] * part for part in self._upwards])


def _read_selected(params: Parameters) -> list[float]:
    found = params.get(_SELECTED.name)
    if (
        not isinstance(found, list)
        or len(found) != len(_AXES)
        or not all(isinstance(each, bool) for each in found)
    ):
        _SELECTED.refuse(params, found, "a list of 6 booleans")
    return [float(each) for each in found]
