"""Enforce the limits of all joints of one kind of command in one call.

Source: ros_control@633c374 joint_limits_interface.h, JointLimitsInterface and the six
interfaces derived from it; differs: every interface can be reset, and an unknown joint
raises `ResourceNotFoundError` as in every other interface.
"""

from collections.abc import Collection, Sequence
from typing import TypeVar

from typing_extensions import override

from station.core.hardware.interfaces.resource_manager import ResourceManager
from station.core.hardware.limits.joint_limits_handle import (
    Arithmetic,
    Clamp,
    EffortJointSaturationHandle,
    EffortJointSoftLimitsHandle,
    JointLimitsGroup,
    JointLimitsHandle,
    PositionJointRateLimitsHandle,
    PositionJointSaturationHandle,
    PositionJointSoftLimitsHandle,
    VelocityJointRateLimitsHandle,
    VelocityJointSaturationHandle,
    VelocityJointSoftLimitsHandle,
)
from station.core.hardware.limits.limited_joints import (
    MOST_JOINTS,
    EnforcedLimits,
    LimitedRun,
)

L = TypeVar("L", bound=JointLimitsHandle)


class JointLimitsInterface(ResourceManager[L]):
    """Hold the limit handles of a robot, filled at start and enforced in `write`.

    Limits of one kind are enforced in one call, and in place if the joints lie side by
    side in the robot's doubles. Handles are grouped when they are first enforced: to
    group all of them at every registration took a fifth of the start of an arm.
    """

    def __init__(self) -> None:
        super().__init__()
        self._members: list[L] = []
        self._groups: list[tuple[JointLimitsGroup, list[L]]] = []
        # Handles that another interface has grouped, or whose class overrides
        # `enforce_limits`.
        self._single: list[L] = []
        self._is_grouped = True
        self._runs = EnforcedLimits()

    @override
    def __init_subclass__(cls) -> None:
        """Name the interface as ros_control does."""
        super().__init_subclass__()
        cls.type_name = f"joint_limits_interface::{cls.__name__}"

    @override
    def register_handle(self, handle: L) -> None:
        super().register_handle(handle)
        self._members = self.handles()
        self._is_grouped = False

    @property
    def enforced(self) -> EnforcedLimits:
        """The limits to enforce in every cycle; ask again after a registration."""
        if not self._is_grouped:
            self._group_all()
        return self._runs

    def activate(self, names: Collection[str]) -> None:
        """Enforce the limits of these joints only, until a handle is registered.

        At first the limits of all joints are enforced. Control thread.

        Args:
            names: Names of joints; names that are not registered are ignored.
        """
        enforced = self.enforced  # grouped, if they were not
        runs: list[LimitedRun] = []
        for group, members in self._groups:
            first = 0
            for last in range(1, len(members) + 1):
                is_end = last == len(members) or members[last].name not in names
                if members[last - 1].name not in names:
                    first = last
                elif is_end:
                    runs.append(_run_of(group, first, last, members[first:last]))
        enforced.runs = runs
        enforced.singles = [h for h in self._single if h.name in names]

    def enforce_limits(self, period: float) -> None:
        """Enforce the limits of all active joints. Control thread.

        Args:
            period: Time since the last cycle [s], > 0.
        """
        if not self._is_grouped:
            self._group_all()
        self._runs.enforce(period)  # in every cycle: the property would cost a call

    def reset(self) -> None:
        """Forget all previous commands. Control thread, at a cycle boundary."""
        for handle in self._members:
            handle.reset()

    @property
    def clamp_count(self) -> int:
        """The number of commands that were changed, over all joints. Any thread."""
        return sum(handle.clamp_count for handle in self._members)

    def last_clamps(self) -> list[Clamp]:
        """Return the latest clamp of every joint that had one. Any thread."""
        clamps = [handle.last_clamp for handle in self._members]
        return [clamp for clamp in clamps if clamp is not None]

    def _group_all(self) -> None:
        """Group the handles, and enforce all of them."""
        self._is_grouped = True
        self._group_handles()
        self.activate(self.get_names())

    def _group_handles(self) -> None:
        mine = [member for _, members in self._groups for member in members]
        self._groups, self._single = [], []
        alike: dict[tuple[Arithmetic, int], list[L]] = {}
        for handle in self._members:
            # A handle keeps its last command in one group only; a second group would
            # limit it again.
            if handle.enforces_alone or (handle.is_grouped and handle not in mine):
                self._single.append(handle)
            else:
                key = (handle.arithmetic, id(handle.joint.command_storage))
                alike.setdefault(key, []).append(handle)
        for (arithmetic, _), handles in alike.items():
            for members in _side_by_side(handles):
                group = JointLimitsGroup(
                    arithmetic,
                    [member.joint for member in members],
                    [member.bounds for member in members],
                    # The new group takes over the memory of the old one, so that
                    # registering another joint causes no jump.
                    [member.memory() for member in members],
                )
                for slot, member in enumerate(members):
                    member.join(group, slot)
                self._groups.append((group, members))


def _run_of(
    group: JointLimitsGroup, first: int, last: int, members: Sequence[JointLimitsHandle]
) -> LimitedRun:
    def count(mask: int) -> None:
        for i, member in enumerate(members):
            if mask >> i & 1:
                member.count_clamp()

    return LimitedRun(group.in_place, group.enforce, first, last, count)


def _side_by_side(handles: list[L]) -> list[list[L]]:
    """Return the handles in groups whose commands lie side by side."""
    groups: list[list[L]] = [[]]
    expected = -1
    # Joints side by side in memory are limited in one loop.
    for handle in sorted(handles, key=lambda handle: handle.joint.command_index):
        if handle.joint.command_index != expected or len(groups[-1]) == MOST_JOINTS:
            groups.append([])
        groups[-1].append(handle)
        expected = handle.joint.command_index + 1
    return groups[1:]


class PositionJointSaturationInterface(
    JointLimitsInterface[PositionJointSaturationHandle]
):
    """Limits of position-controlled joints without soft limits."""


class PositionJointSoftLimitsInterface(
    JointLimitsInterface[PositionJointSoftLimitsHandle]
):
    """Limits of position-controlled joints with soft limits."""


class VelocityJointSaturationInterface(
    JointLimitsInterface[VelocityJointSaturationHandle]
):
    """Limits of velocity-controlled joints without soft limits."""


class VelocityJointSoftLimitsInterface(
    JointLimitsInterface[VelocityJointSoftLimitsHandle]
):
    """Limits of velocity-controlled joints with soft limits."""


class EffortJointSaturationInterface(JointLimitsInterface[EffortJointSaturationHandle]):
    """Limits of effort-controlled joints without soft limits."""


class EffortJointSoftLimitsInterface(JointLimitsInterface[EffortJointSoftLimitsHandle]):
    """Limits of effort-controlled joints with soft limits."""


class PositionJointRateLimitsInterface(
    JointLimitsInterface[PositionJointRateLimitsHandle]
):
    """Limits of position-controlled joints against the command of the last cycle."""


class VelocityJointRateLimitsInterface(
    JointLimitsInterface[VelocityJointRateLimitsHandle]
):
    """Limits of velocity-controlled joints against the command of the last cycle."""
