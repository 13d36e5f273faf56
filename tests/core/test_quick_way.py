"""A method that a subclass replaces is called, whatever its base does more quickly."""

import pytest

from station.core.clock import ManualClock
from station.core.control.controller_manager import ControllerManager
from station.core.loop.control_loop import ControlLoop
from station.core.parameters import Parameters, ParameterTree
from station.core.quick_way import is_in_force
from station.hw.franka.franka_hw import FrankaHW
from tests.hw.franka.test_franka_hw import ROBOT


class Base:
    """Has a method and a quicker way."""

    def plain(self):
        """Do it."""

    def quick(self):
        """Do it quickly."""


class Slower(Base):
    """Replaces the method alone."""

    def plain(self):
        """Do it otherwise."""


class Quicker(Slower):
    """Has a quicker way again."""

    def quick(self):
        """Do the other thing quickly."""


@pytest.mark.parametrize(
    ("kind", "expected"), [(Base, True), (Slower, False), (Quicker, True)]
)
def test_the_newest_of_both_counts(kind, expected):
    assert is_in_force(kind(), "quick", "plain") is expected


def test_a_method_of_the_object_itself_counts_before_all():
    thing = Quicker()
    thing.plain = lambda: None
    assert not is_in_force(thing, "quick", "plain")


class Watched(FrankaHW):
    """Notes in every cycle that it is asked."""

    def __init__(self):
        super().__init__()
        self.asked = []

    def read(self, time, period):
        self.asked.append("read")
        super().read(time, period)

    def write(self, time, period):
        self.asked.append("write")
        super().write(time, period)

    def mode(self):
        self.asked.append("mode")
        return super().mode()


def test_a_loop_calls_what_a_subclass_replaces():
    robot, clock = Watched(), ManualClock()
    tree = ParameterTree({"robot": ROBOT})
    robot.init(Parameters(tree), Parameters(tree, "robot"))
    manager = ControllerManager(robot, Parameters(), [], clock)

    ControlLoop(robot, manager, clock=clock).step(2)

    assert robot.asked == ["read", "write", "mode"] * 2
