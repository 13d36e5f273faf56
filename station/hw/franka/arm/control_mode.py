"""Decide which controllers may share an arm, and in which mode. Pure functions.

Source: franka_ros@c11f000 franka_hw/include/franka_hw/control_mode.h,
franka_hw/src/control_mode.cpp, resource_helpers.cpp, franka_hw.cpp
(FrankaHW::checkForConflict, setRunFunction); differs: every conflict is described, not
only the first one found, and an unsupported mode is refused with its name.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import IntFlag
from types import MappingProxyType

from station.core.hardware.robot_hw import ControllerInfo, ResourceConflict
from station.hw.franka.arm.robot_arm import MotionGeneratorMode

_DOF = 7


class ControlMode(IntFlag):
    """The kinds of command that running controllers give; a set."""

    NONE = 0
    JOINT_TORQUE = 1
    JOINT_POSITION = 2
    JOINT_VELOCITY = 4
    CARTESIAN_VELOCITY = 8
    CARTESIAN_POSE = 16

    def describe(self) -> str:
        """Return the names of the kinds, e.g. `joint_torque, joint_position`."""
        return ", ".join(str(kind.name).lower() for kind in self) or "<none>"


MODE_OF_INTERFACE: Mapping[str, ControlMode] = MappingProxyType({
    "hardware_interface::EffortJointInterface": ControlMode.JOINT_TORQUE,
    "hardware_interface::PositionJointInterface": ControlMode.JOINT_POSITION,
    "hardware_interface::VelocityJointInterface": ControlMode.JOINT_VELOCITY,
    "franka_hw::FrankaVelocityCartesianInterface": ControlMode.CARTESIAN_VELOCITY,
    "franka_hw::FrankaPoseCartesianInterface": ControlMode.CARTESIAN_POSE,
})
"""The command interfaces, each with the mode that a claim through it needs."""

GENERATOR_OF_MODE: Mapping[ControlMode, MotionGeneratorMode] = MappingProxyType({
    ControlMode.NONE: MotionGeneratorMode.NONE,
    ControlMode.JOINT_POSITION: MotionGeneratorMode.JOINT_POSITION,
    ControlMode.JOINT_VELOCITY: MotionGeneratorMode.JOINT_VELOCITY,
    ControlMode.CARTESIAN_VELOCITY: MotionGeneratorMode.CARTESIAN_VELOCITY,
    ControlMode.CARTESIAN_POSE: MotionGeneratorMode.CARTESIAN_POSITION,
})
"""The motion generator for each supported mode without its torque part. A mode is
supported, with or without `JOINT_TORQUE`, if it is listed here: 10 of the 32
combinations."""

_JOINT_MOTIONS = ControlMode.JOINT_POSITION | ControlMode.JOINT_VELOCITY
_CARTESIAN_MOTIONS = ControlMode.CARTESIAN_VELOCITY | ControlMode.CARTESIAN_POSE
_JOINT_MODES = ControlMode.JOINT_TORQUE | _JOINT_MOTIONS


@dataclass(frozen=True, slots=True)
class Claim:
    """One resource that one controller claims through one interface."""

    controller: str
    interface: str
    resource: str


def is_supported(mode: ControlMode) -> bool:
    """Return whether an arm supports a mode."""
    return mode & ~ControlMode.JOINT_TORQUE in GENERATOR_OF_MODE


def arm_id_of(resource: str) -> str | None:
    """Return the arm that a resource belongs to, e.g. `panda` for `panda_joint1`.

    It is the text before the last `_joint`, or else before the last `_robot`; None if
    the resource belongs to no arm.
    """
    for marker in ("_joint", "_robot"):
        # The last marker counts: the name of an arm may itself contain `_joint`.
        arm_id, found, _ = resource.rpartition(marker)
        if found and arm_id:
            return arm_id
    return None


def claims_of(controllers: Iterable[ControllerInfo]) -> list[Claim]:
    """Return every claim of some controllers."""
    return [
        Claim(controller.name, claimed.hardware_interface, resource)
        for controller in controllers
        for claimed in controller.claimed_resources
        for resource in claimed.resources
    ]


def control_mode_of(controllers: Iterable[ControllerInfo], arm_id: str) -> ControlMode:
    """Return the mode that some controllers together need from an arm.

    A kind of command is part of it if all seven joints, or the Cartesian resource, are
    claimed.
    """
    counts = _count_claims(claims_of(controllers), arm_id)
    mode = ControlMode.NONE
    for kind, count in counts.items():
        if count == (_DOF if kind & _JOINT_MODES else 1):
            mode |= kind
    return mode


def find_conflicts(
    controllers: Sequence[ControllerInfo], arm_id: str
) -> list[ResourceConflict]:
    """Return the reasons why some controllers cannot share an arm.

    The tests run in order, and only the first failure is reported: one mistake gives
    one message.

    Args:
        controllers: All controllers that would be running.
        arm_id: Name of the arm. Claims of other arms are only checked for duplicates.

    Returns:
        One entry per conflict; empty when they can run together.
    """
    claims = claims_of(controllers)
    own = [claim for claim in claims if arm_id_of(claim.resource) == arm_id]
    return (
        _double_claims(claims)
        or _unknown_claims(claims)
        or _mixed_claims(own, arm_id)
        or _partial_claims(own, arm_id)
    )


def _count_claims(claims: Iterable[Claim], arm_id: str) -> dict[ControlMode, int]:
    counts: dict[ControlMode, int] = {}
    for claim in claims:
        kind = MODE_OF_INTERFACE.get(claim.interface)
        if kind is not None and arm_id_of(claim.resource) == arm_id:
            counts[kind] = counts.get(kind, 0) + 1
    return counts


def _double_claims(claims: Sequence[Claim]) -> list[ResourceConflict]:
    by_resource: dict[str, list[Claim]] = {}
    for claim in claims:
        by_resource.setdefault(claim.resource, []).append(claim)
    conflicts = []
    for resource, holders in by_resource.items():
        kinds = [MODE_OF_INTERFACE.get(holder.interface) for holder in holders]
        torques = kinds.count(ControlMode.JOINT_TORQUE)
        if len(holders) > 2 or (len(holders) == 2 and torques != 1):
            reason = (
                f"Resource '{resource}' is claimed by {_describe(holders)}; allowed is "
                "one claim, or one of torque and one of a motion."
            )
            conflicts.append(_conflict(resource, holders, reason))
    return conflicts


def _unknown_claims(claims: Sequence[Claim]) -> list[ResourceConflict]:
    conflicts = []
    for claim in claims:
        if arm_id_of(claim.resource) is None:
            reason = (
                f"Resource '{claim.resource}' of '{claim.controller}' names no arm; "
                "the name must be <arm_id>_joint<n> or <arm_id>_robot."
            )
        elif claim.interface not in MODE_OF_INTERFACE:
            reason = (
                f"'{claim.controller}' claims '{claim.resource}' through "
                f"{claim.interface}; an arm knows {', '.join(MODE_OF_INTERFACE)}."
            )
        else:
            continue
        conflicts.append(_conflict(claim.resource, [claim], reason))
    return conflicts


def _mixed_claims(own: Sequence[Claim], arm_id: str) -> list[ResourceConflict]:
    joint = [c for c in own if _is_kind(c, _JOINT_MOTIONS)]
    cartesian = [c for c in own if _is_kind(c, _CARTESIAN_MOTIONS)]
    if not joint or not cartesian:
        return []
    reason = (
        f"Arm '{arm_id}' cannot follow a joint motion and a Cartesian one at once: "
        f"{_describe([*joint[:1], *cartesian])}."
    )
    return [_conflict(cartesian[0].resource, [*joint[:1], *cartesian], reason)]


def _partial_claims(own: Sequence[Claim], arm_id: str) -> list[ResourceConflict]:
    conflicts = []
    for kind, count in _count_claims(own, arm_id).items():
        if kind & _JOINT_MODES and count != _DOF:
            holders = [c for c in own if _is_kind(c, kind)]
            reason = (
                f"Arm '{arm_id}' takes {kind.describe()} commands for all {_DOF} "
                f"joints or for none, but {count} are claimed by {_describe(holders)}."
            )
            conflicts.append(_conflict(holders[0].resource, holders, reason))
    return conflicts


def _is_kind(claim: Claim, kinds: ControlMode) -> bool:
    return bool(MODE_OF_INTERFACE.get(claim.interface, ControlMode.NONE) & kinds)


def _describe(holders: Sequence[Claim]) -> str:
    parties = dict.fromkeys((h.controller, h.interface) for h in holders)
    return " and ".join(f"'{name}' ({interface})" for name, interface in parties)


def _conflict(resource: str, holders: Sequence[Claim], reason: str) -> ResourceConflict:
    parties = dict.fromkeys((h.controller, h.interface) for h in holders)
    return ResourceConflict(resource, tuple(parties), reason)
