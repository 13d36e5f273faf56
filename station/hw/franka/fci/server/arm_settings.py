"""The settings that a client changes: their checks, and the arm's setter of each.

Source: libfranka@0.9.2 include/franka/robot.h, the setters of Robot; Franka Control
Interface documentation. Differs: a simulated arm gives way in all directions when it is
guided, and has no filters of its own, so that only these settings are accepted.
"""

from collections.abc import Callable, Mapping, Sequence
from math import isfinite
from typing import Any

from station.core.errors import InvalidCommandError
from station.core.franka.franka_services import CollisionBehavior
from station.hw.franka.arm.collision_behavior import collision_behavior_problem
from station.hw.franka.arm.load import Load
from station.hw.franka.arm.robot_arm import RobotArm
from station.hw.franka.arm.service_limits import ServiceLimits, check_load
from station.hw.franka.arm.transform_check import check_transform
from station.hw.franka.commands.arm_services import (
    JOINT_STIFFNESS,
    ROTATIONAL_STIFFNESS,
    TRANSLATIONAL_STIFFNESS,
)
from station.hw.franka.fci.wire.robot_protocol import Command

NO_FILTER = 1000.0
"""Cutoff frequency with which a filter of the arm does nothing [Hz]. Source:
libfranka@0.9.2 include/franka/lowpass_filter.h, kMaxCutoffFrequency."""

_LIMITS = ServiceLimits()


def _set_collision_behavior(arm: RobotArm, values: Mapping[str, Any]) -> None:
    behavior = CollisionBehavior(**values)
    problem = collision_behavior_problem(behavior)
    if problem is not None:
        raise InvalidCommandError(f"{problem.field} must be {problem.allowed}.")
    arm.set_collision_behavior(behavior)


def _set_joint_impedance(arm: RobotArm, values: Mapping[str, Any]) -> None:
    _check_ranges("K_theta", values["K_theta"], [JOINT_STIFFNESS] * 7)
    arm.set_joint_impedance(values["K_theta"])


def _set_cartesian_impedance(arm: RobotArm, values: Mapping[str, Any]) -> None:
    ranges = [TRANSLATIONAL_STIFFNESS] * 3 + [ROTATIONAL_STIFFNESS] * 3
    _check_ranges("K_x", values["K_x"], ranges)
    arm.set_cartesian_impedance(values["K_x"])


def _set_guiding_mode(_arm: RobotArm, values: Mapping[str, Any]) -> None:
    if not all(values["guiding_mode"]):
        raise InvalidCommandError("A simulated arm is guided in all directions alone.")


def _set_ee_to_k(arm: RobotArm, values: Mapping[str, Any]) -> None:
    arm.set_stiffness_frame(check_transform(values["EE_T_K"], "EE_T_K"))


def _set_ne_to_ee(arm: RobotArm, values: Mapping[str, Any]) -> None:
    arm.set_end_effector_frame(check_transform(values["NE_T_EE"], "NE_T_EE"))


def _set_load(arm: RobotArm, values: Mapping[str, Any]) -> None:
    mass, center, inertia = values["m_load"], values["F_x_Cload"], values["I_load"]
    check_load(mass, center, inertia, _LIMITS)
    arm.set_load(Load(mass, center, inertia))


def _set_filters(_arm: RobotArm, values: Mapping[str, Any]) -> None:
    if any(frequency != NO_FILTER for frequency in values.values()):
        raise InvalidCommandError(f"A simulated arm filters with {NO_FILTER} Hz alone.")


SETTERS: Mapping[Command, Callable[[RobotArm, Mapping[str, Any]], None]] = {
    Command.SET_COLLISION_BEHAVIOR: _set_collision_behavior,
    Command.SET_JOINT_IMPEDANCE: _set_joint_impedance,
    Command.SET_CARTESIAN_IMPEDANCE: _set_cartesian_impedance,
    Command.SET_GUIDING_MODE: _set_guiding_mode,
    Command.SET_EE_TO_K: _set_ee_to_k,
    Command.SET_NE_TO_EE: _set_ne_to_ee,
    Command.SET_LOAD: _set_load,
    Command.SET_FILTERS: _set_filters,
}
"""What changes a setting of the arm: `setter(arm, fields of the request)`.

Each raises `InvalidCommandError` for impossible values, and `ArmCommandError` when the
arm cannot change the setting now."""


def _check_ranges(
    name: str, values: Sequence[float], ranges: Sequence[tuple[float, float]]
) -> None:
    for value, (low, high) in zip(values, ranges, strict=True):
        if not (isfinite(value) and low <= value <= high):
            raise InvalidCommandError(
                f"{name} has {value}; allowed are {low:g} to {high:g}."
            )
