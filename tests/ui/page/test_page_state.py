"""The state of the docks."""

import json

import pytest

from station.ui.page.page_state import enabling, page_state
from station.wire import ClaimedResources, ControllerType
from tests.ui.views import arm, controller, element, sample, status, view

GROUP = "effort_controllers/JointGroupPositionController"


def _group(name, state="initialized", joints=("joint1", "joint2")):
    return controller(name, state, joints).model_copy(update={"type": GROUP})


def _types(*names):
    return tuple(
        ControllerType(type=name, base_class="Controller", description="")
        for name in names
    )


def test_the_first_group_position_controller_enables_the_sliders():
    told = enabling(view(controller("effort"), _group("one"), _group("two")))
    assert (told.name, told.replaces, told.type) == ("one", (), "")


def test_the_controllers_of_both_arms_enable_the_sliders_together():
    left, right = ("left_1", "left_2"), ("right_1",)
    holder = controller("trajectory", "running", ("right_1",))
    loaded = (_group("left", joints=left), _group("right", joints=right))
    told = enabling(view(holder, *loaded, _group("all", joints=left + right)))
    assert (told.name, told.also) == ("left", ("right",))
    assert told.replaces == ("trajectory",)


def test_what_holds_the_joints_is_replaced():
    holder = controller("trajectory", "running", ("joint2",))
    assert enabling(view(holder, _group("one"))).replaces == ("trajectory",)


def test_nothing_is_offered_while_something_takes_values():
    running = view(_group("one", "running"), elements={"one": (element(),)})
    assert enabling(running).name == ""


def test_a_station_without_such_a_controller_gets_one_over_its_joints():
    positions = {"left_joint1": 0.0, "left_finger_joint1": 0.0}
    told = enabling(view(types=_types(GROUP), positions=positions))
    assert told.type == GROUP
    assert "left_joint1" in told.parameters
    assert "finger" not in told.parameters


def test_a_stopped_station_says_why_not_now():
    assert "stopped" in enabling(view(_group("one"), stop_state="stopped")).reason


def test_the_state_is_json_with_all_that_the_docks_need():
    shown = view(_group("one"), limits={"joint1": (-1.0, 1.0)})
    told = json.loads(json.dumps(page_state(shown)))
    row = told["controllers"][0]
    assert (row["name"], row["claims_short"]) == ("one", ["effort 1-2"])
    assert told["limits"] == {"joint1": [-1.0, 1.0]}
    assert told["enabling"]["name"] == "one"


@pytest.mark.parametrize(
    ("resources", "words"),
    [
        (["panda_joint1", "panda_joint2"], "effort 1-2"),
        (["panda_finger_joint1"], "effort finger 1"),
        (["FL_HAA", "FR_HAA"], "effort FL_HAA, FR_HAA"),
        (["a1", "b1", "c1", "d1"], "effort, 4 joints"),
    ],
)
def test_a_claim_is_told_in_few_words(resources, words):
    kind = "hardware_interface::EffortJointInterface"
    claim = ClaimedResources(hardware_interface=kind, resources=resources)
    shown = view(_group("one").model_copy(update={"claimed_resources": [claim]}))
    arms = status(robots=[arm("panda", "idle")])
    told = page_state(type(shown)(**{**_fields(shown), "status": arms}))
    assert told["controllers"][0]["claims_short"] == [words]


def test_an_arm_with_an_error_is_to_be_recovered_first():
    seen = view(_group("one"))
    hurt = status(robots=[arm("panda", "reflex")])
    told = enabling(type(seen)(**{**_fields(seen), "status": hurt}))
    assert told.reason == "Recover the arm first."


def _fields(seen):
    return {name: getattr(seen, name) for name in type(seen).__dataclass_fields__}


def test_joints_wait_for_the_first_set_point_of_their_controller():
    elements = {"one": (element(),)}
    running = _group("one", "running")

    waiting = page_state(view(running, elements=elements))["operated"]
    known = page_state(view(running, elements=elements, samples={"one": sample(1.0)}))

    assert waiting["names"] == ["one"]
    assert waiting["reason"] == "Waiting for the first set-point of one."
    assert known["operated"]["reason"] == ""
