"""Check, limit, filter and send the commands of an arm."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from station.core.franka.command_rates import CommandRates
from station.hw.franka.arm.receiver import Receiver

if TYPE_CHECKING:
    from station.core.hardware.limits.enforced_limits import EnforcedLimits
    from station.hw.franka.commands.pose_sending import PoseSend
    from station.memory.finite_check import FiniteCheck


class JointSend:
    """Filters commands of the joints and passes them on.

    Args:
        rates: Filters them.
        receiver: Takes them.
        prepare: Called first; None for nothing.
    """

    def __init__(
        self,
        rates: CommandRates,
        receiver: Receiver,
        prepare: Callable[[], object] | None = None,
    ) -> None:
        self.rates = rates
        self.receiver = receiver
        self.prepare = prepare
        self.result = rates.result

    def send(self) -> None:
        """Filter and send."""
        raise NotImplementedError


class PositionSend(JointSend):
    """Filters positions and passes them on; see `JointSend`."""

    def send(self) -> None:
        """Filter and send."""
        if self.prepare is not None:
            self.prepare()
        self.rates.filter_positions()
        self.receiver.receive(self.result)


class VelocitySend(JointSend):
    """Filters velocities and passes them on; see `JointSend`."""

    def send(self) -> None:
        """Filter and send."""
        if self.prepare is not None:
            self.prepare()
        self.rates.filter_velocities()
        self.receiver.receive(self.result)


class TorqueSend(JointSend):
    """Filters torques and passes them on; see `JointSend`."""

    def send(self) -> None:
        """Filter and send."""
        self.rates.filter_torques()
        self.receiver.receive(self.result)


class CommandSending:
    """Sends the commands of the present mode; a subclass does what is not usual.

    Attributes:
        checks: Look for commands that are not finite.
        limits: The limits of the commands that are sent.
        sends: What is sent for the joints.
        goals: Notes positions as goals before they are limited; None for nothing.
        is_cartesian: Whether poses or twists are sent.
        pose_send: Sends a pose in a usual cycle; None if `send_end_effector` always
            has to.
    """

    def __init__(self) -> None:
        self.checks: list[FiniteCheck] = []
        self.limits: list[EnforcedLimits] = []
        self.sends: list[JointSend] = []
        self.goals: CommandRates | None = None
        self.is_cartesian = False
        self.pose_send: PoseSend | None = None

    def refuse(self) -> None:
        """End the motion, because a command is not finite."""
        raise NotImplementedError

    def send_end_effector(self, is_new: bool) -> None:  # noqa: FBT001 - as `send`
        """Filter and send a pose or a twist."""
        raise NotImplementedError

    def send_limited(self, period: float) -> None:
        """Limit and send the controllers' commands, while a motion runs.

        The motion ends when a command is not finite.

        Args:
            period: Time since the last cycle [s], >= 0.
        """
        for check in self.checks:
            if check.first_bad() >= 0:
                self.refuse()
                return
        if self.goals is not None:
            self.goals.note_goals()
        if period > 0.0:
            for limits in self.limits:
                limits.enforce(period)
        for one in self.sends:
            one.send()
        if self.is_cartesian and (self.pose_send is None or not self.pose_send.send()):
            self.send_end_effector(True)  # noqa: FBT003 - as `send`
