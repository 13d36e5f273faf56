"""Follow a set-point in the cycles in which none arrives and none expires."""

from collections.abc import Sized

from station.kernel.command_laws import CommandLaw
from station.kernel.doubles import zeros
from station.kernel.joint_errors import JointErrors
from station.kernel.pid import PidGroup
from station.kernel.sample_columns import SampleColumns
from station.kernel.usual_update import UsualUpdate

_INF = float("inf")


class SetPointNews:
    """What a control thread has to look at before it goes on with a set-point.

    Args:
        slot: Holds the set-point that waits; empty when none does.

    Attributes:
        is_void: Whether the set-points were made void.
        deadline: When the set-point in force expires [s]; infinite when it does not.
    """

    def __init__(self, slot: Sized) -> None:
        self.slot = slot
        self.is_void = False
        self.deadline = _INF

    def is_possible(self) -> bool:
        """Return whether there may be news."""
        return len(self.slot) > 0 or self.is_void or self.deadline != _INF


class SetPointInForce:
    """The set-point that a controller follows.

    Args:
        news: Whether another one may have come.
        size: The number n of its values.

    Attributes:
        desired: The values, shape (n,); always the same memory.
        desired_rates: The rates at which they change, shape (n,); always the same
            memory.
        has_rates: Whether the rates are known.
    """

    def __init__(self, news: SetPointNews, size: int) -> None:
        self.news = news
        self.desired = zeros(size)
        self.desired_rates = zeros(size)
        self.has_rates = False


class SetPointPidLaw(CommandLaw):
    """Commands what PIDs compute from the errors of a set-point.

    Args:
        set_point: The set-point.
        errors: Compares its values with the measured ones.
        rate_errors: Compares its rates.
        pids: One PID per joint.
    """

    def __init__(
        self,
        set_point: SetPointInForce,
        errors: JointErrors,
        rate_errors: JointErrors,
        pids: PidGroup,
    ) -> None:
        self.set_point = set_point
        self.errors = errors
        self.rate_errors = rate_errors
        self.pids = pids

    def command(self, period: float) -> None:
        """Compute the errors, and the commands from them."""
        self.errors.compare()
        if self.set_point.has_rates:
            self.rate_errors.compare()
            self.pids.follow(period, True)  # noqa: FBT003 - a C function
        else:
            self.pids.follow(period, False)  # noqa: FBT003 - a C function


class SetPointUpdate(UsualUpdate):
    """Commands the joints towards the set-point in force.

    Args:
        set_point: The set-point.
        law: Computes the commands.
        sampled: Keeps what was done.

    Attributes:
        period: Time between the last two cycles [s].
    """

    def __init__(
        self, set_point: SetPointInForce, law: CommandLaw, sampled: SampleColumns
    ) -> None:
        self.set_point = set_point
        self.law = law
        self.sampled = sampled
        self.period = 0.0

    def run(self, time: float, period: float) -> bool:
        """Follow the set-point unless there may be another one."""
        if self.set_point.news.is_possible():
            return False
        self.follow(time, period)
        return True

    def follow(self, time: float, period: float) -> None:
        """Follow the set-point in force.

        Args:
            time: Station time of the cycle [s].
            period: Time since the last cycle [s], >= 0.
        """
        self.period = period
        self.law.command(period)
        self.sampled.keep(time)
