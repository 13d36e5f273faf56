"""The limits that are enforced on the commands of a robot in every cycle."""

from collections.abc import Callable
from typing import Protocol

from station.core.hardware.limits.limited_joints import LimitedJoints


class LimitedJoint(Protocol):
    """A joint that enforces its limits in its own way."""

    def enforce_limits(self, period: float) -> None:
        """Enforce them."""


class LimitedRun:
    """Joints that follow one another in a group, and are limited in one call.

    Args:
        joints: The limits of the group's joints, whose memory is the robot's own; None
            if values are copied to and fro.
        enforce: Does the same as `joints.enforce`, with copies if they are needed.
        first: Index of the first joint in the group.
        last: Index after the last joint.
        count: Counts the commands that were changed, given one bit for each joint.
    """

    def __init__(
        self,
        joints: LimitedJoints | None,
        enforce: Callable[[float, int, int], int],
        first: int,
        last: int,
        count: Callable[[int], None],
    ) -> None:
        self.joints = joints
        self.enforce = enforce
        self.first = first
        self.last = last
        self.count = count


class EnforcedLimits:
    """All limits of one kind of command.

    Attributes:
        runs: Joints that are limited together.
        singles: Joints that are limited one by one.
    """

    def __init__(self) -> None:
        self.runs: list[LimitedRun] = []
        self.singles: list[LimitedJoint] = []

    def enforce(self, period: float) -> None:
        """Enforce all of them.

        Args:
            period: Time since the last cycle [s], > 0.
        """
        for run in self.runs:
            joints = run.joints
            if joints is not None:
                mask = joints.enforce(period, run.first, run.last)
            else:
                mask = run.enforce(period, run.first, run.last)
            if mask:
                run.count(mask)
        for single in self.singles:
            single.enforce_limits(period)
