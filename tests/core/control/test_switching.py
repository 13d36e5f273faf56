"""What a switch would do, and why it is refused."""

import pytest

from station.core.control.controller import ControllerState
from station.core.control.switching import (
    Candidate,
    Strictness,
    SwitchRequest,
    conflict_error,
    plan_switch,
)
from station.core.errors import SwitchRefusedError
from station.core.hardware.robot_hw import ControllerInfo, ResourceConflict

BEST_EFFORT = Strictness.BEST_EFFORT


def candidate(name, state):
    return Candidate(ControllerInfo(name, "test/Type", ()), ControllerState(state))


LOADED = [
    candidate("a", "initialized"),
    candidate("b", "running"),
    candidate("c", "stopped"),
    candidate("d", "running"),
]


def names(infos):
    return [info.name for info in infos]


@pytest.mark.parametrize("value", [0, 1, 7, -1])
def test_every_number_but_two_is_best_effort(value):
    assert Strictness.from_value(value) is BEST_EFFORT


def test_two_is_strict():
    assert Strictness.from_value(2) is Strictness.STRICT


def test_transitions_are_in_load_order_and_requests_as_asked():
    plan = plan_switch(LOADED, SwitchRequest(start=["c", "a"], stop=["d", "b"]))

    assert plan.start_requests == ("c", "a")
    assert plan.stop_requests == ("d", "b")
    assert names(plan.start) == ["a", "c"]
    assert names(plan.stop) == ["b", "d"]
    assert names(plan.running) == ["a", "c"]


def test_a_controller_that_keeps_running_takes_part_in_the_conflict_check():
    plan = plan_switch(LOADED, SwitchRequest(start=["a"], stop=["b"]))

    assert names(plan.running) == ["a", "d"]


@pytest.mark.parametrize(
    ("start", "stop", "words"),
    [
        (["nope"], [], "'nope' cannot start: it is not loaded"),
        ([], ["nope"], "'nope' cannot stop: it is not loaded"),
        (["b"], [], "'b' cannot start: it is running already"),
        ([], ["c"], "'c' cannot stop: it is stopped, not running"),
        (["a"], ["a"], "'a' cannot stop: it is initialized, not running"),
    ],
)
def test_strict_refuses_with_the_reason(start, stop, words):
    with pytest.raises(SwitchRefusedError, match=words) as caught:
        plan_switch(LOADED, SwitchRequest(start, stop))

    assert caught.value.details["controller"] == (start + stop)[0]
    assert caught.value.remedy


@pytest.mark.parametrize(
    ("start", "stop", "remedy"),
    [(["nope"], [], "Load it first."), ([], ["nope"], "Leave it out of 'stop'.")],
)
def test_an_unknown_controller_is_told_with_what_helps(start, stop, remedy):
    with pytest.raises(SwitchRefusedError) as caught:
        plan_switch(LOADED, SwitchRequest(start, stop))

    assert caught.value.remedy.endswith(remedy)


def test_best_effort_leaves_out_what_is_impossible_and_says_so():
    request = SwitchRequest(["a", "nope", "b"], ["c", "nope"], BEST_EFFORT)

    plan = plan_switch(LOADED, request)

    assert names(plan.start) == ["a"]
    assert names(plan.stop) == []
    assert len(plan.ignored) == 4


@pytest.mark.parametrize("strictness", list(Strictness))
def test_a_running_controller_cannot_be_restarted_in_one_switch(strictness):
    with pytest.raises(SwitchRefusedError, match="stopped and started"):
        plan_switch(LOADED, SwitchRequest(["b"], ["b"], strictness))


def test_best_effort_simply_starts_what_it_should_stop_and_start():
    plan = plan_switch(LOADED, SwitchRequest(["c"], ["c"], BEST_EFFORT))

    assert names(plan.start) == ["c"]
    assert names(plan.stop) == []


def test_a_name_may_be_there_twice():
    plan = plan_switch(LOADED, SwitchRequest(["a", "a"], ["b", "b"]))

    assert plan.start_requests == ("a", "a")
    assert names(plan.start) == ["a"]
    assert names(plan.stop) == ["b"]


def test_a_conflict_tells_who_holds_the_resource():
    conflict = ResourceConflict("j1", (("b", "Effort"), ("a", "Position")), "Both.")

    error = conflict_error([conflict], ["b", "d"])

    assert error.details["held_by"] == ["b"]
    (entry,) = error.details["conflicts"]
    assert entry["resource"] == "j1"
    assert entry["held_by"] == "b"
    assert entry["hardware_interface"] == "Effort"
    assert {"controller": "a", "hardware_interface": "Position"} in entry["claimed_by"]
    assert "'b'" in error.remedy


def test_a_conflict_among_those_to_start_is_held_by_nobody():
    conflict = ResourceConflict("j1", (("a", "Effort"), ("c", "Effort")), "Both.")

    error = conflict_error([conflict], [])

    assert error.details["held_by"] == []
    assert error.details["conflicts"][0]["held_by"] is None
