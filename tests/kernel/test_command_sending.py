"""The commands of an arm: checked, limited, filtered and passed on, in that order."""

from typing_extensions import override

from station.kernel.command_sending import CommandSending, JointSend, Receiver
from station.kernel.doubles import doubles
from station.kernel.enforced_limits import EnforcedLimits
from station.kernel.finite_check import FiniteCheck


class Limited:
    """A joint that notes when its limits are enforced."""

    def __init__(self, done):
        self.done = done

    def enforce_limits(self, period):
        self.done.append(f"limit {period:g}")


class Sending(CommandSending):
    """Notes what is done."""

    def __init__(self):
        super().__init__()
        self.done = []
        self.commands = doubles([1.0, 2.0])
        self.checks = [FiniteCheck(self.commands)]
        limits = EnforcedLimits()
        limits.singles = [Limited(self.done)]
        self.limits = [limits]
        receiver = Receiver(lambda values: self.done.append([*values]))
        self.sends = [
            JointSend(lambda: self.done.append("filter"), receiver, self.commands)
        ]

    @override
    def refuse(self):
        self.done.append("refuse")

    @override
    def note_goals(self):
        self.done.append("goals")

    @override
    def send_end_effector(self, is_new):
        self.done.append(f"pose {is_new}")


def test_commands_are_limited_filtered_and_passed_on():
    sending = Sending()
    sending.send_limited(0.001)
    assert sending.done == ["limit 0.001", "filter", [1.0, 2.0]]


def test_goals_are_noted_before_the_limits_and_poses_come_last():
    sending = Sending()
    sending.has_goals = sending.is_cartesian = True
    sending.send_limited(0.001)
    assert sending.done[0] == "goals"
    assert sending.done[-1] == "pose True"


def test_no_time_has_no_limits():
    sending = Sending()
    sending.send_limited(0.0)
    assert sending.done == ["filter", [1.0, 2.0]]


def test_a_command_that_is_not_finite_is_refused_and_nothing_is_sent():
    sending = Sending()
    sending.commands[1] = float("inf")
    sending.send_limited(0.001)
    assert sending.done == ["refuse"]
