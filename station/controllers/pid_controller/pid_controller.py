"""Compute commands from references by one PID for each degree of freedom.

Source: ros2_controllers@6.x pid_controller/src/pid_controller.cpp, pid_controller.yaml;
`enable_feedforward`, `antiwindup` and `legacy` are those of @4.x.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite, isinf, nan, sqrt
from typing import ClassVar

from typing_extensions import override

from station.controllers.joint_references import JointReferenceController
from station.controllers.pid_controller.saturating_pids import (
    STRATEGIES,
    SaturatingPids,
)
from station.controllers.set_point_controller import ControlledJoints, JointQuantity
from station.core.control.chainable_controller import (
    ExportedState,
)
from station.core.control.controller import ControllerSample, require_interface
from station.core.control.tunables import Tunable, Tunables
from station.core.declared_parameter import (
    EACH_JOINT,
    DeclaredParameter,
    NameKind,
    declare_boolean,
    declare_number,
    declare_string,
    declare_strings,
)
from station.core.description.robot_description import (
    JointDescription,
    find_robot_description,
)
from station.core.errors import ControllerLoadError
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointCommandInterface,
    JointHandle,
    JointStateGroup,
    JointStateInterface,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.robot_hw import RobotHW
from station.core.numerics.joint_errors import CONTINUOUS, PLAIN, JointErrors
from station.core.parameters import Parameters
from station.core.ports.set_point import (
    timeout_parameters,
)
from station.memory.doubles import put, zeros

_INTERFACES: Mapping[str, type[JointCommandInterface]] = {
    "position": PositionJointInterface,
    "velocity": VelocityJointInterface,
    "effort": EffortJointInterface,
}
_DERIVATIVES = (("position",), ("velocity",), ("effort",), ("position", "velocity"))
_DOF_NAMES = declare_strings(
    "dof_names",
    "what is commanded: joints, or references `controller/joint`",
    names=NameKind.JOINT,
)
_STATE_NAMES = declare_strings(
    "reference_and_state_dof_names",
    "the joints that are measured and have references",
    names=NameKind.JOINT,
    default_text="dof_names",
)
_COMMAND = declare_string(
    "command_interface",
    "what is commanded: `position`, `velocity` or `effort`",
    choices=tuple(_INTERFACES),
)
_MEASURED = declare_strings(
    "reference_and_state_interfaces",
    "what is compared: one interface, or `position` and `velocity`",
)
_EXTERNAL = declare_boolean(
    "use_external_measured_states",
    "must be false: there is no topic of measured values",
    default=False,
)
_FEEDS_FORWARD = declare_boolean(
    "enable_feedforward",
    "whether references times feedforward_gain are added to the commands",
    default=True,
)
_FIRST = declare_boolean(
    "set_current_state_as_first_setpoint",
    "false commands nothing before the first set-point or preceding controller",
    default=True,
)


def _gain(
    name: str,
    text: str,
    default: float | None = 0.0,
    default_text: str = "",
    unit: str = "",
) -> DeclaredParameter:
    return declare_number(
        f"gains/{EACH_JOINT}/{name}", text, default, unit, default_text=default_text
    )


_P = _gain("p", "proportional gain")
_I = _gain("i", "integral gain")
_D = _gain("d", "derivative gain")
_FORWARD = _gain(
    "feedforward_gain", "factor of the reference, or of its rate if it has one"
)
_PART_MAX = _gain(
    "i_clamp_max", "upper bound of the integral part, >= 0", None, "none; legacy: 0"
)
_PART_MIN = _gain(
    "i_clamp_min", "lower bound of the integral part, <= 0", None, "none; legacy: 0"
)
_MAX = _gain("u_clamp_max", "upper bound of the command", None, "none")
_MIN = _gain("u_clamp_min", "lower bound of the command", None, "none")
_TRACKING = _gain(
    "tracking_time_constant",
    "time in which `back_calculation` draws the integral part back",
    None,
    "sqrt(d / i), or p / i without d",
    unit="s",
)
_DEADBAND = _gain("error_deadband", "errors that are not integrated", 1e-16)
_ANTIWINDUP = declare_boolean(
    f"gains/{EACH_JOINT}/antiwindup",
    "whether `legacy` bounds the integral itself",
    default=False,
)
_WRAPS = declare_boolean(
    f"gains/{EACH_JOINT}/angle_wraparound",
    "whether the error is the shorter way round",
    default=False,
)
_SATURATES = declare_boolean(
    f"gains/{EACH_JOINT}/saturation", "false ignores the bounds u_clamp", default=True
)
_SAVES = declare_boolean(
    f"gains/{EACH_JOINT}/save_i_term",
    "whether the integral part outlives a stop",
    default=True,
)
_STRATEGY = declare_string(
    f"gains/{EACH_JOINT}/antiwindup_strategy",
    "`none`, `legacy`, `back_calculation` or `conditional_integration`",
    default_text="legacy with antiwindup, else none",
)
_GAINS = (
    _P,
    _I,
    _D,
    _FORWARD,
    _PART_MAX,
    _PART_MIN,
    _MAX,
    _MIN,
    _TRACKING,
    _DEADBAND,
    _ANTIWINDUP,
    _WRAPS,
    _SATURATES,
    _SAVES,
    _STRATEGY,
)
_TUNED = {
    "p": Tunable("", 0.0, 10_000.0, _P.description),
    "i": Tunable("", 0.0, 10_000.0, _I.description),
    "d": Tunable("", 0.0, 1_000.0, _D.description),
    "feedforward_gain": Tunable("", 0.0, 1_000.0, _FORWARD.description),
}


@dataclass(slots=True)
class _Ports:
    """The measured joints, and where the commands go."""

    joints: ControlledJoints
    commanded: list[JointHandle]


class PidController(JointReferenceController):
    """Commands the output of PIDs for the errors of references.

    The references `<joint>/<interface>` come from a preceding controller, or from
    set-points: values of the first interface, with `rates` for the second. The
    controller exports the measured values under the same names. A start takes the
    measured values for the references.

    Source:
        PidController; differs: a reference without a commander is rest and not NaN;
        `use_external_measured_states` is refused; references beyond the limits of the
        robot description are refused as set-points.
    """

    optional_interfaces: ClassVar[tuple[type, ...]] = (
        *_INTERFACES.values(),
        JointStateInterface,
    )
    accepted_parameters: ClassVar[tuple[str, ...]] = ("export_params",)
    own_parameters = (
        *timeout_parameters(),
        _DOF_NAMES,
        _STATE_NAMES,
        _COMMAND,
        _MEASURED,
        _EXTERNAL,
        _FEEDS_FORWARD,
        _FIRST,
        *_GAINS,
    )

    @override
    def init(self, hw: RobotHW, params: Parameters) -> None:
        commanded = _DOF_NAMES.read_str_list(params)
        self.joint_names = _STATE_NAMES.read_str_list(params, commanded)
        if not commanded or len(self.joint_names) != len(commanded):
            _DOF_NAMES.refuse(params, commanded, "one name for each measured joint")
        if _EXTERNAL.read_bool(params):
            raise ControllerLoadError(
                "The controller cannot take measured values from a topic.",
                remedy="Leave `use_external_measured_states` out, or set it to false.",
            )
        self._kinds = tuple(_MEASURED.read_str_list(params))
        if self._kinds not in _DERIVATIVES:
            _MEASURED.refuse(
                params, list(self._kinds), "one interface, or position and velocity"
            )
        self._starts_at_state = _FIRST.read_bool(params)
        command = _COMMAND.read_str(params)
        states = require_interface(hw, JointStateInterface)
        commands = require_interface(hw, _INTERFACES[command])
        self._ports = _Ports(
            ControlledJoints(
                JointStateGroup([states.get_handle(n) for n in self.joint_names])
            ),
            [commands.get_handle(name) for name in commanded],
        )
        quantities = [JointQuantity(kind) for kind in self._kinds]
        self._measured = [each.measured(self._ports.joints) for each in quantities]
        self._exported = [zeros(len(commanded)) for _ in quantities]
        self._pids = SaturatingPids(len(commanded))
        description = find_robot_description(params)
        joints = [
            JointDescription(name) if description is None else description.joint(name)
            for name in self.joint_names
        ]
        self.make_references(params, joints, quantities)
        self._read_gains(params, commanded)

    @override
    def on_export_state_interfaces(self) -> Sequence[ExportedState]:
        return [
            ExportedState(f"{name}/{kind}", exported, k)
            for kind, exported in zip(self._kinds, self._exported, strict=True)
            for k, name in enumerate(self.joint_names)
        ]

    @override
    def starting(self, time: float) -> None:
        self._ports.joints.read()
        pids = self._pids
        kept = [
            part * saves for part, saves in zip(pids.parts, self._saves, strict=True)
        ]
        pids.reset()
        put(pids.parts, kept)
        super().starting(time)
        for references, measured in zip(self.references, self._measured, strict=True):
            put(references, measured)
        self._first = self._active.values
        self._waits = not self._starts_at_state

    @override
    def update_reference_from_subscribers(self, time: float, period: float) -> None:
        # The references of the start stay until something takes their place.
        if self._active.newest() is not self._first:
            super().update_reference_from_subscribers(time, period)

    @override
    def update_and_write_commands(self, time: float, period: float) -> None:
        pids, references = self._pids, self.references
        self._ports.joints.read()
        self._errors.compare()
        if len(references) > 1:
            for k in range(pids.size):
                pids.rates[k] = references[1][k] - self._measured[1][k]
        share = self.tunables.values["enable_feedforward"]
        for k in range(pids.size):
            pids.forward[k] = share * pids.f[k] * references[-1][k]
        if self._waits and not (self.is_in_chained_mode or self._active.port.last):
            put(pids.errors, [nan] * pids.size)
        else:
            self._waits = False
        pids.compute_commands(period, len(references) > 1)
        for k, handle in enumerate(self._ports.commanded):
            if isfinite(pids.errors[k]):
                handle.set_command(pids.commands[k])
        for exported, measured in zip(self._exported, self._measured, strict=True):
            put(exported, measured)
        self.sample = ControllerSample(
            time,
            [*references[0]],
            [*self._measured[0]],
            [*pids.errors],
            [handle.get_command() for handle in self._ports.commanded],
        )

    @override
    def rest(self, n: int) -> list[float]:
        if self._kinds[n] == "position":
            return [*self._measured[n]]
        return [0.0] * len(self.joint_names)

    def _read_gains(self, params: Parameters, names: Sequence[str]) -> None:
        pids = self._pids
        self._errors = JointErrors(self.references[0], self._measured[0], pids.errors)
        schema = {
            "enable_feedforward": Tunable("", 0.0, 1.0, _FEEDS_FORWARD.description)
        }
        values = {"enable_feedforward": float(_FEEDS_FORWARD.read_bool(params))}
        for k, name in enumerate(names):
            strategy = _read_strategy(params, name)
            pids.strategies[k] = STRATEGIES[strategy]
            self._read_bounds(params, name, k, 0.0 if "legacy" in strategy else inf)
            pids.deadband[k] = _DEADBAND.of(name).read_float(params)
            wraps = _WRAPS.of(name).read_bool(params)
            self._errors.set_wrapping(k, CONTINUOUS if wraps else PLAIN, -inf, inf)
            for key, gain in zip(_TUNED, (_P, _I, _D, _FORWARD), strict=True):
                declared = gain.of(name)
                value = declared.read_float(params)
                tunable = _TUNED[key].including(value)
                schema[f"{name}/{key}"] = replace(tunable, parameter=declared.name)
                values[f"{name}/{key}"] = value
        self._saves = [_SAVES.of(name).read_bool(params) for name in names]
        self._tracking = [_optional(_TRACKING.of(name), params, 0.0) for name in names]
        for name, tracking in zip(names, self._tracking, strict=True):
            if tracking < 0.0:
                _TRACKING.of(name).refuse(params, tracking, "0 or more")
        self._gain_names = list(names)
        self.tunables = Tunables(schema, values, apply=self._apply)
        self._apply(values)

    def _read_bounds(self, params: Parameters, name: str, k: int, part: float) -> None:
        """Read the bounds of one PID; `part` bounds an integral part without any."""
        pids = self._pids
        pids.part_max[k] = _optional(_PART_MAX.of(name), params, part)
        pids.part_min[k] = _optional(_PART_MIN.of(name), params, -part)
        if pids.part_max[k] < 0.0:
            _PART_MAX.of(name).refuse(params, pids.part_max[k], "0 or more")
        if pids.part_min[k] > 0.0:
            _PART_MIN.of(name).refuse(params, pids.part_min[k], "0 or less")
        if _SATURATES.of(name).read_bool(params):
            pids.maximum[k] = _optional(_MAX.of(name), params, inf)
            pids.minimum[k] = _optional(_MIN.of(name), params, -inf)
        if pids.minimum[k] >= pids.maximum[k]:
            above = f"more than u_clamp_min, {pids.minimum[k]}"
            _MAX.of(name).refuse(params, pids.maximum[k], above)

    def _apply(self, values: Mapping[str, float]) -> None:
        pids = self._pids
        for k, name in enumerate(self._gain_names):
            p, i, d = (values[f"{name}/{key}"] for key in ("p", "i", "d"))
            pids.p[k], pids.i[k], pids.d[k] = p, i, d
            pids.f[k] = values[f"{name}/feedforward_gain"]
            time = self._tracking[k]
            if time == 0.0 and i != 0.0:
                time = sqrt(d / i) if d / i > 0.0 else p / i
            # Without a time the integral part is drawn back in about a cycle.
            pids.tracking[k] = time if time > 0.0 else 1e-3


def _optional(declared: DeclaredParameter, params: Parameters, absent: float) -> float:
    value = params.get(declared.name)
    # The defaults of ROS 2 are infinite, and files may repeat them.
    if isinstance(value, float) and isinf(value):
        return value
    return absent if value is None else declared.read_float(params)


def _read_strategy(params: Parameters, name: str) -> str:
    antiwindup = _ANTIWINDUP.of(name).read_bool(params)
    declared = _STRATEGY.of(name)
    found = "legacy" if params.has(_ANTIWINDUP.of(name).name) else "none"
    if params.has(declared.name):
        found = params.get_str(declared.name)
    if found == "legacy" and antiwindup:
        found = "legacy with antiwindup"
    if found not in STRATEGIES:
        allowed = ", ".join(each for each in STRATEGIES if " " not in each)
        declared.refuse(params, f"'{found}'", f"one of {allowed}")
    return found
