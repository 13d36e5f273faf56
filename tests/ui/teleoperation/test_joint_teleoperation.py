"""The joint commands of a person, with an injected clock."""

from dataclasses import replace

import pytest

from station.ui.teleoperation.joint_teleoperation import (
    FASTEST,
    HELD_FOR,
    SHOWN_FOR,
    UNKNOWN_START,
    JointTeleoperation,
    Movers,
)
from tests.ui.views import controller, element, sample, status, view

NAMES = ("joint1", "joint2")
SPEED = JointTeleoperation().speed


def _view(**changes):
    elements = tuple(element(name) for name in NAMES)
    parts = {
        "elements": {"arm": elements},
        "samples": {"arm": sample(1.0, desired=0.1, names=NAMES)},
        **changes,
    }
    return view(controller("arm", "running", NAMES), **parts)


@pytest.fixture
def desk():
    return _at_start()


def _at_start(movers=None, **changes):
    """Return the commands of a person who has just looked at the robot."""
    made = JointTeleoperation(movers)
    made.refresh(_view(**changes))
    return made


def _step(desk, now=0.04, dt=0.04):
    """Return the set-point of the only controller, or None."""
    return next(iter(desk.step(dt, now)), None)


def test_nothing_is_sent_unasked(desk):
    assert _step(desk, 0.0) is None


def test_a_typed_value_arrives_exactly_and_no_faster_than_allowed(desk):
    assert desk.go({"joint2": 0.3217}, now=0.0) == ""
    first = _step(desk, 0.04)
    assert first.controller == "arm"
    assert first.values == [None, pytest.approx(0.12)]
    sent = [_step(desk, 1.0) for _ in range(14)]
    assert [s.values for s in sent if s is not None][-1] == [None, 0.3217]
    assert sent[-1] is None


def test_a_value_out_of_range_moves_nothing(desk):
    said = desk.go({"joint1": 0.2, "joint2": 1.5}, now=0.0)
    assert said == "joint2 cannot go to 1.5 rad; allowed are -1 to 1 rad."
    assert _step(desk, 0.0) is None


def test_an_unknown_joint_is_named(desk):
    assert "does not command elbow" in desk.go({"elbow": 0.0}, now=0.0)
    assert "does not command elbow" in desk.hold("elbow", 1, now=0.0)


def test_a_held_button_moves_until_it_is_released(desk):
    desk.hold("joint1", -1, now=0.0)
    moved = _step(desk, 0.04)
    assert moved.values[0] == pytest.approx(0.08)
    desk.release()
    assert _step(desk, 0.08) is None


def test_a_browser_that_falls_silent_releases_its_buttons(desk):
    desk.hold("joint1", 1, now=0.0)
    assert _step(desk, HELD_FOR - 0.01) is not None
    assert _step(desk, HELD_FOR + 0.01) is None
    assert desk.remaining == 0.0


def test_releasing_a_button_ends_no_motion_to_a_typed_value(desk):
    desk.go({"joint2": 0.5}, now=0.0)
    desk.hold("joint1", 1, now=0.0)
    _step(desk, 0.04)
    desk.release()
    assert _step(desk, 0.08).values == [None, pytest.approx(0.14)]


def test_a_held_button_does_not_take_back_what_somebody_else_moves_since():
    movers = Movers()
    ada, grace = _at_start(movers), _at_start(movers)
    for one in (ada, grace):
        one.hold("joint1", 1, now=0.0)
        _step(one, 0.04)
        one.confirm("arm")
    ada.hold("joint1", 1, now=0.05)
    assert ada.give_up_lost() == ["joint1"]
    assert _step(ada, 0.08) is None
    assert grace.give_up_lost() == []


@pytest.mark.parametrize(("unit", "limit"), [("m", 1.0), ("rad", None)])
def test_joints_that_slide_or_turn_without_end_move_while_a_button_is_held(unit, limit):
    ends = {"minimum": None if limit is None else -limit, "maximum": limit}
    elements = {"arm": tuple(element(name, unit, **ends) for name in NAMES)}
    desk = _at_start(elements=elements)
    values = []
    for round_ in range(100):
        assert desk.hold("joint1", -1, now=0.04 * round_) == ""
        values.append(_step(desk, 0.04 * round_).values[0])
    least = 0.1 - 100 * 0.04 * SPEED
    assert min(values) == pytest.approx(least if limit is None else -limit)
    desk.release()
    assert _step(desk, 4.0) is None


@pytest.mark.parametrize(
    "change", [{"stop_state": "stopped"}, {"age": 5.0}, {"elements": {}}]
)
def test_no_motion_survives_a_stop_a_lost_link_or_another_controller(desk, change):
    desk.go({"joint1": 0.9}, now=0.0)
    desk.refresh(_view(**change))
    assert _step(desk, 0.04) is None
    assert desk.go({"joint1": 0.9}, now=0.0) != ""


def test_velocities_are_typed_and_not_jogged():
    desk = _at_start(elements={"arm": tuple(element(n, "rad/s") for n in NAMES)})
    assert "takes rad/s, not positions" in desk.hold("joint1", 1, now=0.0)
    desk.go({"joint1": 0.4}, now=0.0)
    assert _step(desk, 0.04).values == [0.4, None]


def _told(desk, *values):
    """Let the controller have been told these values."""
    desk.refresh(_view(samples={"arm": sample_of(values)}))


def sample_of(values):
    """Return a sample with one set-point for each joint."""
    one = sample(1.0, names=NAMES)
    return one.model_copy(update={"desired": list(values)})


@pytest.fixture
def still():
    """Both joints rest, one of them away from zero."""
    desk = _at_start(samples={"arm": sample_of((0.0, 0.5))})
    desk.speed = 1.0
    return desk


def test_a_touched_joint_travels_at_the_top_speed_and_no_other_is_commanded(still):
    still.go({"joint1": 0.25}, now=0.0)
    assert _step(still, dt=0.1).values == [0.1, None]
    assert still.remaining == pytest.approx(0.15)
    assert _step(still, dt=0.1).values == [0.2, None]
    assert _step(still, dt=0.1).values == [0.25, None]
    assert _step(still, dt=0.1) is None


def test_a_touched_joint_travels_in_the_negative_direction_as_well(still):
    still.go({"joint2": 0.0}, now=0.0)
    assert _step(still, dt=0.1).values == [None, 0.4]


def test_following_does_not_disturb_a_move(still):
    still.go({"joint1": 1.0}, now=0.0)
    _step(still, dt=0.1)
    _told(still, 0.9, 0.9)
    assert _step(still, dt=0.1).values == [0.2, None]


def test_velocities_and_efforts_are_sent_at_once():
    elements = {"arm": (element("joint1", "rad/s"), element("joint2", "Nm"))}
    desk = _at_start(elements=elements)
    desk.go({"joint1": 0.8}, now=0.0)
    assert _step(desk, dt=0.01).values == [0.8, None]


class _Station:
    """Fills in the elements that a set-point leaves out, as the station does."""

    def __init__(self, *values):
        self.values = list(values)

    def step(self, desk, *, refuses=False):
        """Take the next step of a person, who then hears of all of the set-point."""
        set_point = _step(desk, dt=0.1)
        if set_point is None or refuses:
            return
        pairs = zip(set_point.values, self.values, strict=True)
        self.values = [told if new is None else new for new, told in pairs]
        desk.confirm("arm")


@pytest.fixture
def pair():
    movers = Movers()
    start = {"arm": sample_of((0.0, 0.0))}
    desks = [_at_start(movers, samples=start) for _ in range(2)]
    for desk in desks:
        desk.speed = 1.0
    return desks


def test_two_people_move_different_joints_at_the_same_time(pair):
    station = _Station(0.0, 0.0)
    pair[0].go({"joint1": 0.5}, now=0.0)
    seen = []
    for round_ in range(6):
        if round_ == 2:
            pair[1].go({"joint2": -0.3}, now=0.2)
        for desk in pair:
            station.step(desk)
            seen.append(list(station.values))
    assert station.values == [0.5, -0.3]
    assert [a for a, _ in seen] == sorted(a for a, _ in seen)
    assert [b for _, b in seen] == sorted((b for _, b in seen), reverse=True)


def test_of_two_people_who_move_the_same_joint_the_later_one_does(pair):
    station, (ada, grace) = _Station(0.0, 0.0), pair
    ada.go({"joint1": 1.0, "joint2": 1.0}, now=0.0)
    station.step(ada)
    _told(grace, *station.values)
    grace.go({"joint1": -1.0}, now=0.1)
    station.step(grace)
    assert ada.give_up_lost() == ["joint1"]
    assert ada.give_up_lost() == []
    station.step(ada)
    station.step(grace)
    assert station.values == [pytest.approx(-0.1), 0.2]
    ada.go({"joint1": 0.5}, now=0.3)  # What is asked for anew is the later one.
    station.step(ada)
    assert grace.give_up_lost() == ["joint1"]
    assert ada.give_up_lost() == []


def test_a_motion_that_arrives_at_once_ends_that_of_somebody_else(pair):
    station, (ada, grace) = _Station(0.0, 0.0), pair
    ada.go({"joint1": 1.0}, now=0.0)
    station.step(ada)
    grace.go({"joint1": 0.05}, now=0.1)
    station.step(grace)
    assert ada.give_up_lost() == ["joint1"]


def test_an_answer_that_comes_late_takes_no_joint_back(pair):
    station, (ada, grace) = _Station(0.0, 0.0), pair
    ada.go({"joint1": 1.0}, now=0.0)
    station.step(ada)
    _step(ada, dt=0.1)  # on its way to the station
    grace.go({"joint1": -1.0}, now=0.1)
    station.step(grace)
    ada.confirm("arm")
    assert ada.give_up_lost() == ["joint1"]
    assert grace.give_up_lost() == []


def test_who_asks_anew_before_hearing_of_the_loss_moves_the_joint(pair):
    station, (ada, grace) = _Station(0.0, 0.0), pair
    for desk, target in ((ada, 1.0), (grace, -1.0), (ada, 0.5)):
        desk.go({"joint1": target}, now=0.0)
        station.step(desk)
    assert ada.give_up_lost() == []
    assert grace.give_up_lost() == ["joint1"]


def test_no_motion_survives_a_new_epoch(still):
    still.go({"joint1": 1.0}, now=0.0)
    still.refresh(replace(_view(), status=status(epoch=2)))
    assert _step(still, dt=0.1) is None
    still.go({"joint1": 1.0}, now=0.0)
    assert _step(still, dt=0.1).epoch == 2


def test_a_refused_command_ends_nobody_elses_motion(pair):
    station, (ada, grace) = _Station(0.0, 0.0), pair
    ada.go({"joint1": 1.0}, now=0.0)
    station.step(ada)
    grace.go({"joint1": -1.0}, now=0.1)
    station.step(grace, refuses=True)
    assert ada.give_up_lost() == []


def test_letting_go_ends_a_move_until_the_robot_is_known_again(still):
    still.go({"joint1": 1.0}, now=0.0)
    still.let_go()
    assert _step(still, dt=0.1) is None
    assert still.go({"joint1": 1.0}, now=0.1) == UNKNOWN_START


def test_a_released_slider_keeps_its_value_and_then_follows_the_robot(still):
    still.go({"joint1": 0.1}, now=5.0)
    assert still.shown("joint1", now=5.5) is None
    assert still.shown("joint2", now=5.5) == 0.5
    _step(still, now=5.5, dt=1.0)
    assert still.shown("joint1", now=5.0 + 2 * SHOWN_FOR) == 0.1


def test_sliders_are_left_alone_while_nothing_is_known():
    assert JointTeleoperation().shown("joint1", now=0.0) is None


ARMS = {"left": ("left_joint1", "left_joint2"), "right": ("right_joint1",)}


def _two_arms(*running, **changes):
    return view(
        *(controller(name, "running", ARMS[name]) for name in running),
        **{
            "elements": {n: tuple(map(element, ARMS[n])) for n in running},
            "samples": {n: sample(1.0, desired=0.1, names=ARMS[n]) for n in running},
            **changes,
        },
    )


@pytest.fixture
def arms():
    made = JointTeleoperation()
    made.refresh(_two_arms("left", "right"))
    return made


def _sent(arms):
    return {one.controller: one.values for one in arms.step(0.04, 0.04)}


def test_all_running_controllers_are_commanded(arms):
    assert arms.controllers == ["left", "right"]
    assert arms.reason == ""
    assert _sent(arms) == {}


def test_a_value_goes_to_the_controller_of_its_joint_alone(arms):
    assert arms.go({"right_joint1": 0.11}, now=0.0) == ""
    assert _sent(arms) == {"right": [0.11]}
    assert arms.go({"left_joint2": 0.11}, now=0.0) == ""
    assert _sent(arms) == {"left": [None, 0.11]}


def test_a_pose_of_both_arms_moves_all_of_them_or_none(arms):
    refused = arms.go({"left_joint1": 0.11, "right_joint1": 7.0}, now=0.0)
    assert "right_joint1 cannot go to 7 rad" in refused
    assert _sent(arms) == {}
    assert arms.go({"left_joint1": 0.11, "right_joint1": 0.11}, now=0.0) == ""
    assert _sent(arms) == {"left": [0.11, None], "right": [0.11]}


def test_nothing_moves_while_it_is_not_known_where_one_arm_was_told_to_be():
    arms = JointTeleoperation()
    samples = {"left": sample(1.0, desired=0.1, names=ARMS["left"])}
    arms.refresh(_two_arms("left", "right", samples=samples))
    refused = arms.go({"left_joint1": 0.11, "right_joint1": 0.11}, now=0.0)
    assert "not known yet" in refused
    assert _sent(arms) == {}


def test_a_button_of_each_arm_moves_it_until_it_is_released(arms):
    arms.set_speed(0.5)
    assert arms.hold("right_joint1", -1, now=0.0) == ""
    assert arms.hold("left_joint1", 1, now=0.0) == ""
    assert _sent(arms) == {
        "left": [pytest.approx(0.12), None],
        "right": [pytest.approx(0.08)],
    }
    arms.release()
    assert _sent(arms) == {}


def test_an_arm_goes_on_when_the_controller_of_the_other_stops(arms):
    arms.go({"left_joint1": 0.5, "right_joint1": 0.5}, now=0.0)
    arms.refresh(_two_arms("right"))
    assert list(_sent(arms)) == ["right"]
    arms.refresh(_two_arms("left", "right"))
    assert list(_sent(arms)) == ["right"]  # What ended does not go on by itself.
    arms.let_go()
    assert _sent(arms) == {}


def test_a_joint_that_nobody_commands_is_named(arms):
    assert "does not command elbow" in arms.go({"elbow": 0.0}, now=0.0)
    arms.refresh(_two_arms())
    assert arms.controllers == []
    assert "nothing that runs takes set-points" in arms.reason
    assert arms.hold("left_joint1", 1, now=0.0) == arms.reason


def test_the_speed_stays_within_its_range(arms):
    arms.set_speed(99.0)
    assert arms.speed == FASTEST
