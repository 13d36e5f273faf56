"""Enforce the limits of several joints in one call."""

from collections.abc import Callable, Mapping, Sequence

from station.core.hardware.interfaces.joint import JointHandle
from station.core.hardware.interfaces.joint_group import JointGroup
from station.core.hardware.limits.limited_joints import LIMITS, MEMORY, LimitedJoints
from station.memory.doubles import own_block, put

_OTHERS = ("position", "velocity", "command", "asked", "reason")


class JointLimitsGroup:
    """Joints whose limits are of one kind, and what is remembered of their commands.

    Joints that lie side by side in a robot's doubles are limited in place. Values of
    other joints are copied to and fro.

    Args:
        arithmetic: The kind of limits.
        joints: The joints, n of them, at most `MOST_JOINTS`.
        limits: The values named in `LIMITS`, for each joint.
        memory: The values named in `MEMORY`, for each joint.

    Attributes:
        enforce: `LimitedJoints.enforce` of the joints. Control thread.
        in_place: The limits, if they work on the robot's own memory; otherwise None.
    """

    def __init__(
        self,
        arithmetic: type[LimitedJoints],
        joints: Sequence[JointHandle],
        limits: Sequence[Mapping[str, float]],
        memory: Sequence[Mapping[str, float]],
    ) -> None:
        views = own_block((*LIMITS, *MEMORY, *_OTHERS), len(joints))
        for i, (values, remembered) in enumerate(zip(limits, memory, strict=True)):
            for name in LIMITS:
                views[name][i] = values[name]
            for name in MEMORY:
                views[name][i] = remembered[name]
        self._joints = JointGroup(joints)
        self._views = views
        position, velocity = self._joints.positions, self._joints.velocities
        command = self._joints.commands
        in_place = position is not None and velocity is not None and command is not None
        if position is not None and velocity is not None and command is not None:
            views.update(position=position, velocity=velocity, command=command)
        self._arithmetic = arithmetic(views)
        self.in_place = self._arithmetic if in_place else None
        self.enforce: Callable[[float, int, int], int] = (
            self._arithmetic.enforce if in_place else self._enforce_copies
        )

    def clamp(self, slot: int) -> tuple[float, float, int]:
        """Return the last change of a joint's command.

        Args:
            slot: The joint.

        Returns:
            The command before and after, and the code of the limit.
        """
        views = self._views
        return views["asked"][slot], views["command"][slot], int(views["reason"][slot])

    def memory(self, slot: int) -> dict[str, float]:
        """Return the remembered state of a joint, by the names in `MEMORY`."""
        return {name: self._views[name][slot] for name in MEMORY}

    def remember(self, slot: int, memory: Mapping[str, float]) -> None:
        """Replace what is remembered of a joint.

        Args:
            slot: The joint.
            memory: The values named in `MEMORY`.
        """
        for name in MEMORY:
            self._views[name][slot] = memory[name]

    def _enforce_copies(self, period: float, first: int, last: int) -> int:
        joints, views = self._joints, self._views
        put(views["position"], joints.get_positions())
        put(views["velocity"], joints.get_velocities())
        put(views["command"], joints.get_commands())
        mask = self._arithmetic.enforce(period, first, last)
        joints.set_commands([*views["command"]])
        return mask
