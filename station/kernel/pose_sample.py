"""Keep what a controller of an end effector did in a cycle, as numbers of poses."""

from station.kernel.at_once import copy_into
from station.kernel.doubles import Doubles, doubles, zeros
from station.kernel.model_sources import ModelSource
from station.kernel.rigid_motion import numbers_of
from station.kernel.sample_columns import SampleColumns
from station.kernel.set_points import SetPointNews
from station.kernel.usual_update import UsualUpdate

_NUMBERS = 7
_QUATERNION = 4


class PoseSample:
    """Position and unit quaternion x y z w, desired and measured, and their difference.

    Quaternions of a motion do not jump: of the two of a rotation, the one is kept that
    is nearer to the one before.

    Args:
        pose: The desired pose, 16 numbers.
        source: Writes the measured pose.

    Attributes:
        near: The quaternion of the last cycle, shape (4,).
        sampled: The columns.
    """

    def __init__(self, pose: Doubles, source: ModelSource) -> None:
        self.pose = pose
        self.source = source
        self.near = doubles([0.0, 0.0, 0.0, 1.0])
        self.actual_pose = zeros(16)
        self.desired = zeros(_NUMBERS)
        self.quaternion = self.desired[3:]
        self.actual = zeros(_NUMBERS)
        self.errors = zeros(_NUMBERS)
        self.sampled = SampleColumns((
            self.desired,
            self.actual,
            self.errors,
            self.desired,
        ))

    def keep(self, time: float) -> None:
        """Keep the sample of a cycle.

        Args:
            time: Station time [s].
        """
        near, desired, actual = self.near, self.desired, self.actual
        numbers_of(self.pose, near, desired)
        copy_into(near, 0, self.quaternion, _QUATERNION)
        self.source.write(self.actual_pose)
        numbers_of(self.actual_pose, near, actual)
        for i in range(_NUMBERS):
            self.errors[i] = desired[i] - actual[i]
        self.sampled.keep(time)


class RestingPose(UsualUpdate):
    """Keeps an end effector at rest while no set-point arrives.

    Args:
        news: Whether a set-point may have come.
        sample: What is kept of a cycle.

    Attributes:
        is_resting: Whether the pose rests, and nothing but rest is wanted.
    """

    def __init__(self, news: SetPointNews, sample: PoseSample) -> None:
        self.news = news
        self.sample = sample
        self.is_resting = False

    def run(self, time: float, period: float) -> bool:
        """Keep the sample if the pose rests; see `UsualUpdate.run`."""
        if not self.is_resting or self.news.is_possible():
            return False
        self.sample.keep(time)
        return True
