"""Follow a set-point in the cycles in which none arrives and none expires."""

from station.controllers.forward_command_controller.command_laws import CommandLaw
from station.core.control.sample_columns import SampleColumns
from station.core.control.usual_update import UsualUpdate
from station.core.numerics.joint_errors import JointErrors
from station.core.numerics.pid_group import PidGroup
from station.core.ports.set_point_news import SetPointNews
from station.memory.doubles import zeros


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
