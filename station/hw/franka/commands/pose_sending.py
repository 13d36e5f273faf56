"""Send the poses of a controller to an arm, a new one in every cycle."""

from station.hw.franka.arm.receiver import PoseReceiver
from station.hw.franka.commands.pose_rates import PoseRates
from station.memory.doubles import Doubles, zeros
from station.memory.vectors import copy_into

_POSE = 16
_ELBOW = 2
_KEPT = 3


class PassedPoses:
    """The last three poses that were commanded, for whoever bridges a gap after them.

    Attributes:
        cycle: Number of cycles of the arm.
        is_on_commands: Whether the poses that are sent are those that are commanded.
    """

    def __init__(self) -> None:
        self.cycle = 0
        self.is_on_commands = True
        self.poses = zeros(_KEPT * _POSE)
        self.elbows = zeros(_KEPT * _ELBOW)
        # The cycles of the last pose, of the one before it, and of the one before that.
        self.last_cycle, self.earlier_cycle, self.before_cycle = 0, -1, -2
        # Where the last pose is.
        self.newest = 0

    def note(self, pose: Doubles, elbow: Doubles) -> None:
        """Note the pose of this cycle, 16 numbers, and its elbow, 2 numbers."""
        newest = self.newest + 1
        if newest == _KEPT:
            newest = 0
        self.newest = newest
        copy_into(self.poses, _POSE * newest, pose, _POSE)
        copy_into(self.elbows, _ELBOW * newest, elbow, _ELBOW)
        self.before_cycle, self.earlier_cycle = self.earlier_cycle, self.last_cycle
        self.last_cycle = self.cycle

    def repeats(self, pose: Doubles) -> bool:
        """Return whether a pose is the one that was noted last."""
        start = _POSE * self.newest
        for i in range(_POSE):
            if pose[i] != self.poses[start + i]:
                return False
        return True

    def pass_usual(self, pose: Doubles, elbow: Doubles) -> bool:
        """Note a pose that follows one of the last cycle, and is sent as it is.

        Returns:
            Whether it is such a pose; if not, nothing has changed.
        """
        if not self.is_on_commands or self.cycle != self.before_cycle + 2:
            return False
        self.cycle += 1
        self.note(pose, elbow)
        return True


class PoseSend:
    """Filters poses without an elbow and passes them on.

    Args:
        passed: The poses that were passed on.
        pose: The commanded pose, 16 numbers.
        elbow: Position of joint 3 [rad] and sign of joint 4, or zeros, shape (2,).
        rates: Filters the poses.
        receiver: Takes them.

    Attributes:
        is_usual: Whether a pose was sent in this motion, by whoever does the rest.
    """

    def __init__(
        self,
        passed: PassedPoses,
        pose: Doubles,
        elbow: Doubles,
        rates: PoseRates,
        receiver: PoseReceiver,
    ) -> None:
        self.passed = passed
        self.pose = pose
        self.elbow = elbow
        self.rates = rates
        self.receiver = receiver
        self.is_usual = False

    def send(self) -> bool:
        """Filter and send; return whether that was done."""
        receiver, rates, passed = self.receiver, self.rates, self.passed
        # The filter has come to its end as well.
        is_known = receiver.is_settled() and passed.repeats(self.pose)
        if (
            not self.is_usual
            or not receiver.is_open()
            or self.elbow[0] != 0.0
            or self.elbow[1] != 0.0
            or not passed.pass_usual(self.pose, self.elbow)
        ):
            return False
        if not is_known:
            rates.filter_pose(self.pose, False)  # noqa: FBT003 - positional in C
        return receiver.receive(rates.sent_pose)
