"""The suites find robots, controllers and arms that break their contracts."""

import math

import pytest

from station.core import Controller, EffortJointInterface, SetPointElement, SetPointPort
from station.hw.mock import MockRobotHW
from station.testing import (
    ArmConformance,
    Bench,
    ControllerConformance,
    RobotConformance,
)
from tests.hw.franka.scripted_arm import ScriptedArm


class Drifting(MockRobotHW):
    """Moves although nothing runs."""

    def read(self, time, period):
        super().read(time, period)
        self.joints.position[0] += 0.001


class Forgetful(MockRobotHW):
    """Changes commands when it reads."""

    def read(self, time, period):
        super().read(time, period)
        self.joints.effort_command[0] += 1.0


class Blind(MockRobotHW):
    """Reads NaN."""

    def read(self, time, period):
        super().read(time, period)
        self._measured.effort[0] = math.nan


class Wordy(MockRobotHW):
    """Has a mode of two words."""

    def mode(self):
        return "all well"


class Slow(MockRobotHW):
    """Never finishes a switch."""

    def switch_result_for(self, controller):
        return self.switch_result.__class__


@pytest.mark.parametrize(
    ("robot", "test"),
    [
        (Drifting, "test_it_holds_still_when_nothing_runs"),
        (Forgetful, "test_reading_does_not_change_commands"),
        (Blind, "test_its_states_are_finite_from_the_first_cycle_on"),
        (Wordy, "test_its_mode_is_one_word"),
        (Slow, "test_every_command_interface_can_be_switched_to_and_off_again"),
    ],
)
def test_a_robot_that_breaks_its_contract_is_found(robot, test):
    suite = RobotConformance()
    getattr(suite, test)(Bench())

    with pytest.raises(AssertionError):
        getattr(suite, test)(Bench(robot()))


class Good(Controller[EffortJointInterface]):
    """Commands nothing but rest."""

    hardware_interface = EffortJointInterface

    def init(self, interface, params):
        self.joint = interface.get_handle("joint1")

    def update(self, time, period):
        self.joint.set_command(0.0)


class Pushing(Good):
    """Pushes the joint away as soon as it runs."""

    def update(self, time, period):
        self.joint.set_command(4.0)


class Tired(Good):
    """Starts once only."""

    def stopping(self, time):
        raise RuntimeError("never again")


class Nervous(Good):
    """Cannot live with a cycle of no time."""

    def update(self, time, period):
        self.joint.set_command(0.0 / period)


class Nameless(Good):
    """Takes a set-point whose range is empty."""

    def init(self, interface, params):
        super().init(interface, params)
        self.set_points = SetPointPort([SetPointElement("joint1", "Nm", 1.0, 1.0)])


@pytest.mark.parametrize(
    ("controller", "test", "more"),
    [
        (Pushing, "test_it_starts_without_a_jump_and_lets_the_robot_rest", ()),
        (Tired, "test_it_stops_and_starts_again_and_again", ()),
        (Nervous, "test_it_survives_a_cycle_of_another_length", (0.0,)),
        (Nameless, "test_its_set_point_has_names_units_and_ranges", ()),
    ],
)
def test_a_controller_that_breaks_its_contract_is_found(controller, test, more):
    suite = ControllerConformance()

    def bench(kind):
        bench = suite.make_robot_bench()
        bench.load_controller("it", kind)
        return bench

    if controller is not Nameless:
        getattr(suite, test)(bench(Good), *more)

    with pytest.raises(AssertionError):
        getattr(suite, test)(bench(controller), *more)


def test_an_arm_that_breaks_its_contract_is_found():
    class Restless(ScriptedArm):
        def is_at_rest(self):
            return False

    suite = ArmConformance()
    suite.test_new_arm_is_idle_at_rest_and_free_to_move(ScriptedArm())

    with pytest.raises(AssertionError):
        suite.test_new_arm_is_idle_at_rest_and_free_to_move(Restless())


def test_the_fixture_of_an_arm_must_be_overridden():
    with pytest.raises(NotImplementedError, match="Override the fixture"):
        ArmConformance.arm.__wrapped__(ArmConformance())
