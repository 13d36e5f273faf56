"""A set-point travels at a limited speed."""

import pytest

from station.ui.teleoperation.set_point_ramp import HOLD, Movers, SetPointRamp
from tests.ui.views import element


@pytest.fixture
def ramp():
    ramp = SetPointRamp([element(), element("joint2")])
    ramp.follow([0.0, 0.5])
    return ramp


def test_nothing_is_sent_until_a_slider_is_touched(ramp):
    assert ramp.step(0.1, 1.0) is None
    assert not ramp.commanding


def test_a_touched_joint_travels_at_the_top_speed_and_no_other_is_commanded(ramp):
    ramp.touch(0, 0.25, now=0.0)
    assert ramp.step(0.1, 1.0) == [0.1, None]
    assert ramp.remaining == pytest.approx(0.15)
    assert ramp.step(0.1, 1.0) == [0.2, None]
    assert ramp.step(0.1, 1.0) == [0.25, None]
    assert ramp.step(0.1, 1.0) is None


def test_a_touched_joint_travels_in_the_negative_direction_as_well(ramp):
    ramp.touch(1, 0.0, now=0.0)
    assert ramp.step(0.1, 1.0) == [None, 0.4]


def test_velocities_and_efforts_are_sent_at_once():
    ramp = SetPointRamp([element(unit="rad/s"), element(unit="Nm")])
    ramp.follow([0.0, 0.0])
    ramp.touch(0, 0.8, now=0.0)
    assert ramp.step(0.01, 0.1) == [0.8, None]


def test_following_does_not_disturb_a_move(ramp):
    ramp.touch(0, 1.0, now=0.0)
    ramp.step(0.1, 1.0)
    ramp.follow([9.0, 9.0])
    assert ramp.step(0.1, 1.0) == [0.2, None]


class _Station:
    """Fills in what a set-point leaves out, as the station does."""

    def __init__(self, *values):
        self.values = list(values)

    def step(self, ramp, *, refuses=False):
        """Take the next step of a ramp, which then hears of all of the set-point."""
        command = ramp.step(0.1, 1.0)
        if command is None or refuses:
            return
        pairs = zip(command, self.values, strict=True)
        self.values = [told if new is None else new for new, told in pairs]
        ramp.confirm()


@pytest.fixture
def pair():
    movers = Movers()
    ramps = [SetPointRamp([element(), element("joint2")], movers) for _ in range(2)]
    for ramp in ramps:
        ramp.follow([0.0, 0.0])
    return ramps


def test_two_people_move_different_joints_at_the_same_time(pair):
    station = _Station(0.0, 0.0)
    pair[0].touch(0, 0.5, now=0.0)
    seen = []
    for round_ in range(6):
        if round_ == 2:
            pair[1].touch(1, -0.3, now=0.2)
        for ramp in pair:
            station.step(ramp)
            seen.append(list(station.values))
    assert station.values == [0.5, -0.3]
    assert [a for a, _ in seen] == sorted(a for a, _ in seen)
    assert [b for _, b in seen] == sorted((b for _, b in seen), reverse=True)


def test_of_two_people_who_move_the_same_joint_the_later_one_does(pair):
    station, (ada, grace) = _Station(0.0, 0.0), pair
    ada.touch(0, 1.0, now=0.0)
    ada.touch(1, 1.0, now=0.0)
    station.step(ada)
    grace.follow(station.values)
    grace.touch(0, -1.0, now=0.1)
    station.step(grace)
    assert ada.give_up_lost() == [0]
    assert ada.give_up_lost() == []
    station.step(ada)
    station.step(grace)
    assert station.values == [pytest.approx(-0.1), 0.2]
    ada.touch(0, 0.5, now=0.3)  # What is asked for anew is the later one.
    station.step(ada)
    assert grace.give_up_lost() == [0]
    assert ada.give_up_lost() == []


def test_a_refused_command_ends_nobody_elses_motion(pair):
    station, (ada, grace) = _Station(0.0, 0.0), pair
    ada.touch(0, 1.0, now=0.0)
    station.step(ada)
    grace.touch(0, -1.0, now=0.1)
    station.step(grace, refuses=True)
    assert ada.give_up_lost() == []


def test_letting_go_ends_a_move_until_the_robot_is_known_again(ramp):
    ramp.touch(0, 1.0, now=0.0)
    ramp.let_go()
    assert ramp.step(0.1, 1.0) is None
    assert not ramp.touch(0, 1.0, now=0.1)


def test_a_released_slider_keeps_its_value_and_then_follows_the_robot(ramp):
    ramp.touch(0, 0.1, now=5.0)
    assert ramp.shown(0, now=5.5) is None
    assert ramp.shown(1, now=5.5) == 0.5
    ramp.step(1.0, 1.0)
    assert ramp.shown(0, now=5.0 + 2 * HOLD) == 0.1


def test_sliders_are_left_alone_while_nothing_is_known():
    assert SetPointRamp([element()]).shown(0, now=0.0) is None
