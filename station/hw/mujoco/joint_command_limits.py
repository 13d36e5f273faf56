"""The limits of a simulated robot's joints, and the handles that enforce them."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import inf
from xml.etree import ElementTree

from station.core.interfaces import JointHandle
from station.core.limits import (
    EffortJointSaturationHandle,
    EffortJointSoftLimitsHandle,
    JointLimits,
    JointLimitsHandle,
    PositionJointRateLimitsHandle,
    PositionJointSaturationHandle,
    PositionJointSoftLimitsHandle,
    SoftJointLimits,
    VelocityJointRateLimitsHandle,
    VelocityJointSaturationHandle,
    VelocityJointSoftLimitsHandle,
    joint_limits_from_parameters,
    joint_limits_from_urdf,
    soft_joint_limits_from_parameters,
    soft_joint_limits_from_urdf,
)
from station.core.parameters import Parameters
from station.core.urdf_text import parse_robot_description
from station.hw.mujoco.mujoco_robot_parameters import LimitMode

_Handles = Mapping[str, JointHandle]
"""A joint's command handles by quantity."""


class JointCommandLimits:
    """Limit the commands of the kinds that are in use.

    Limits come from the URDF and then from `joint_limits` in the parameters, which
    win. A velocity limit of 0 in the URDF stands for a joint nobody limited.

    Args:
        xml: The URDF, checked already.
        params: The namespace that has `joint_limits`.
        mode: Which handles enforce them.

    Source: gazebo_ros_control@2.9.2 default_robot_hw_sim.cpp, registerJointLimits;
    differs: one handle per kind of command, of which those in use act.
    """

    def __init__(self, xml: str, params: Parameters, mode: LimitMode) -> None:
        root = parse_robot_description(xml)
        self._elements = {e.get("name", ""): e for e in root.findall("joint")}
        self._params = params
        self._mode = mode
        self._handles: dict[tuple[str, str], JointLimitsHandle] = {}
        self._active: list[JointLimitsHandle] = []

    def add(self, joint: str, commands: _Handles) -> None:
        """Limit a joint from now on.

        Args:
            joint: Its name in the URDF.
            commands: Its command handles by quantity.

        Raises:
            JointLimitsError: Its limits are contradictory.
            RobotDescriptionError: Its limits cannot be read.
        """
        element = self._elements[joint]
        limits = self._read_limits(joint, element)
        soft = self._read_soft_limits(joint, element)
        for quantity, handle in commands.items():
            self._handles[joint, quantity] = self._make(quantity, handle, limits, soft)

    def activate(self, commands: Sequence[tuple[str, str]]) -> None:
        """Choose the commands that are limited, and forget what was before.

        Args:
            commands: Joint and quantity of each command in use.
        """
        active = [self._handles[command] for command in commands]
        for handle in active:
            if handle not in self._active:
                handle.reset()
        self._active = active

    def reset(self) -> None:
        """Forget all previous commands."""
        for handle in self._active:
            handle.reset()

    def enforce(self, period: float) -> None:
        """Limit the commands in use. Control thread.

        Args:
            period: Time since the last cycle [s], > 0.
        """
        for handle in self._active:
            handle.enforce_limits(period)

    def _read_limits(self, joint: str, element: ElementTree.Element) -> JointLimits:
        limits = joint_limits_from_urdf(element) or JointLimits()
        limits = replace(limits, max_velocity=limits.max_velocity or None)
        limits = joint_limits_from_parameters(joint, self._params, limits) or limits
        # The handles want these two.
        return replace(
            limits,
            max_velocity=inf if limits.max_velocity is None else limits.max_velocity,
            max_effort=inf if limits.max_effort is None else limits.max_effort,
        )

    def _read_soft_limits(
        self, joint: str, element: ElementTree.Element
    ) -> SoftJointLimits | None:
        soft = soft_joint_limits_from_urdf(element)
        return soft_joint_limits_from_parameters(joint, self._params, soft) or soft

    def _make(
        self,
        quantity: str,
        handle: JointHandle,
        limits: JointLimits,
        soft: SoftJointLimits | None,
    ) -> JointLimitsHandle:
        if self._mode is LimitMode.RATE:
            if quantity == "position":
                return PositionJointRateLimitsHandle(handle, limits)
            if quantity == "velocity":
                return VelocityJointRateLimitsHandle(handle, limits)
            return EffortJointSaturationHandle(handle, limits)
        if soft is None:
            if quantity == "position":
                return PositionJointSaturationHandle(handle, limits)
            if quantity == "velocity":
                return VelocityJointSaturationHandle(handle, limits)
            return EffortJointSaturationHandle(handle, limits)
        if quantity == "position":
            return PositionJointSoftLimitsHandle(handle, limits, soft)
        if quantity == "velocity":
            return VelocityJointSoftLimitsHandle(handle, limits, soft)
        return EffortJointSoftLimitsHandle(handle, limits, soft)
