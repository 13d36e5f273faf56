"""The limits of a simulated robot's joints, and the handles that enforce them."""

import logging
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from math import inf
from types import MappingProxyType

from station.core.description.ros2_control import InterfaceTag
from station.core.description.urdf import Joint
from station.core.errors import ParameterError
from station.core.hardware.interfaces import JointHandle
from station.core.hardware.limits import (
    JointLimits,
    JointLimitsHandle,
    JointLimitsInterface,
    LimitMode,
    joint_limits_from_parameters,
    joint_limits_from_urdf,
    limits_without_effect,
    make_limits_handle,
    soft_joint_limits_from_parameters,
    soft_joint_limits_from_urdf,
)
from station.core.hardware.robot_report import (
    ClampReport,
    JointLimitsReport,
    limit_values,
    report_clamps,
)
from station.core.parameters import Parameters
from station.hw.mujoco.joint_command_modes import COMMAND_INTERFACES

_logger = logging.getLogger(__name__)
_PARAMETERS = "parameters"
_Handles = Mapping[str, JointHandle]
"""The command handles of a joint by quantity."""


class JointCommandLimits:
    """Limits the commands of joints; only commands that controllers use are limited.

    Limits come from the URDF; `joint_limits` in the parameters override them. A
    velocity limit of 0 in the URDF means that the joint has no velocity limit.

    Args:
        joints: The joints of the URDF.
        params: The namespace that has `joint_limits`.
        mode: Kind of the handles that enforce the limits.
        tags: Command interfaces of `<ros2_control>` by joint. Of a tag's limits and
            those of the URDF the narrower ones apply; a limit that the tag switches off
            does not apply.

    Attributes:
        reports: The limits of every added joint with their sources.

    Raises:
        ParameterError: An entry of `joint_limits` in the robot's own parameters limits
            nothing. Such entries at the root, which may be for ROS, are only logged.

    Source: gazebo_ros_control@2.9.2 default_robot_hw_sim.cpp, registerJointLimits;
    differs: one handle per kind of command; those of the commands in use act.
    """

    def __init__(
        self,
        joints: Mapping[str, Joint],
        params: Parameters,
        mode: LimitMode,
        tags: Mapping[str, Sequence[InterfaceTag]] = MappingProxyType({}),
    ) -> None:
        self._joints = joints
        self._tags = tags
        _tell_limits_without_effect(params, self._joints)
        self._params = params
        self._mode = mode
        self._handles: dict[tuple[str, str], JointLimitsHandle] = {}
        self.reports: list[JointLimitsReport] = []
        self._active: list[JointLimitsHandle] = []
        self._interfaces = {
            quantity: JointLimitsInterface[JointLimitsHandle]()
            for quantity in COMMAND_INTERFACES
        }
        self._enforced: list[JointLimitsInterface[JointLimitsHandle]] = []

    def add(self, joint: str, commands: _Handles) -> None:
        """Limit a joint from now on.

        Args:
            joint: Name of the joint in the URDF.
            commands: Command handles of the joint by quantity.

        Raises:
            JointLimitsError: The limits of the joint are contradictory.
        """
        report = self._read(self._joints[joint])
        self.reports.append(report)
        # The handles need both of these limits.
        limits, soft = report.limits, report.soft_limits
        limits = replace(
            limits,
            max_velocity=inf if limits.max_velocity is None else limits.max_velocity,
            max_effort=inf if limits.max_effort is None else limits.max_effort,
        )
        for quantity, handle in commands.items():
            limited = make_limits_handle(self._mode, quantity, handle, limits, soft)
            self._handles[joint, quantity] = limited
            self._interfaces[quantity].register_handle(limited)

    def activate(self, commands: Sequence[tuple[str, str]]) -> None:
        """Choose the commands that are limited, and forget all previous commands.

        Args:
            commands: Joint and quantity of each command in use.
        """
        active = [self._handles[command] for command in commands]
        for handle in active:
            if handle not in self._active:
                handle.reset()
        self._active = active
        self._enforced = []
        for quantity, interface in self._interfaces.items():
            names = {joint for joint, kind in commands if kind == quantity}
            interface.activate(names)
            if names:
                self._enforced.append(interface)

    def reset(self) -> None:
        """Forget all previous commands."""
        for handle in self._active:
            handle.reset()

    def enforce(self, period: float) -> None:
        """Limit the commands in use. Control thread.

        Args:
            period: Time since the last cycle [s], > 0.
        """
        for interface in self._enforced:
            interface.enforce_limits(period)

    def velocities(self) -> dict[str, float]:
        """Return the velocity limit of each added joint [rad/s or m/s]; inf if none.

        A limit of 0 is left out: a brake with that limit would hold the joint for ever.
        """
        return {
            report.joint: report.limits.max_velocity or inf for report in self.reports
        }

    def clamps(self) -> list[ClampReport]:
        """Return the commands that the limits have changed. Any thread."""
        return report_clamps({
            (joint, COMMAND_INTERFACES[quantity].type_name): handle
            for (joint, quantity), handle in self._handles.items()
        })

    def _read(self, joint: Joint) -> JointLimitsReport:
        params = self._params
        first = joint_limits_from_urdf(joint) or JointLimits()
        first = replace(first, max_velocity=first.max_velocity or None)
        described = limit_values(first, None)
        for tag in self._tags.get(joint.name, ()):
            first = _narrowed(first, tag)
        limits = joint_limits_from_parameters(joint.name, params, first) or first
        first_soft = soft_joint_limits_from_urdf(joint)
        soft = soft_joint_limits_from_parameters(joint.name, params, first_soft)
        soft = soft or first_soft
        before = limit_values(first, first_soft)
        sources = {
            kind: _PARAMETERS
            if value != before.get(kind)
            else _source_in_urdf(
                kind, is_tag=kind != "soft" and value != described.get(kind)
            )
            for kind, value in limit_values(limits, soft).items()
        }
        return JointLimitsReport(joint.name, limits, soft, sources)


def _source_in_urdf(kind: str, *, is_tag: bool) -> str:
    if is_tag:
        return "urdf ros2_control"
    return "urdf safety_controller" if kind == "soft" else "urdf limit"


def _narrowed(limits: JointLimits, tag: InterfaceTag) -> JointLimits:
    """Return the limits, narrowed by a command interface of `<ros2_control>`.

    Source:
        ros2_control@6.x hardware_interface/src/component_parser.cpp,
        update_interface_limits.
    """
    low, high = tag.minimum, tag.maximum
    if tag.name == "position":
        if not tag.is_limited:
            return replace(limits, min_position=None, max_position=None)
        lows = [each for each in (low, limits.min_position) if each is not None]
        highs = [each for each in (high, limits.max_position) if each is not None]
        # A range needs both ends.
        if not lows or not highs:
            return limits
        return replace(limits, min_position=max(lows), max_position=min(highs))
    # The smaller end of an asymmetric range limits both directions.
    ends = [abs(each) for each in (low, high) if each is not None]
    before: float | None = getattr(limits, f"max_{tag.name}")
    ends += [] if before is None else [before]
    most = min(ends, default=None) if tag.is_limited else None
    match tag.name:
        case "velocity":
            return replace(limits, max_velocity=most)
        case "effort":
            return replace(limits, max_effort=most)
        case "acceleration":
            return replace(limits, max_acceleration=most)
        case _:
            return replace(limits, max_jerk=most)


def _tell_limits_without_effect(params: Parameters, joints: Collection[str]) -> None:
    for problem in limits_without_effect(params, joints):
        if params.path:
            raise ParameterError(
                f"A limit has no effect: {params.path}/{problem}",
                remedy="Correct it, or leave it out.",
                details={"parameter": params.resolve("joint_limits")},
            )
        _logger.warning("A limit has no effect: %s", problem)
