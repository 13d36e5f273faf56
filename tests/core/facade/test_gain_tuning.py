"""Gains of several controllers in one cycle, and changes taken back."""

import pytest

from station.core.errors import (
    ControllerNotFoundError,
    InvalidGainError,
    NothingToUndoError,
)
from station.core.facade.gain_tuning import HISTORY
from tests.api.spring import make_station
from tests.two_joint_station import make_station as make_two_joint_station


@pytest.fixture
def station():
    station = make_station()
    for name in ("one", "two"):
        station.load_controller(name, "test/Spring", {"joint": "j", "k": 2.0})
    station.loop.step()
    return station


def stiffness(station):
    return {name: values["k"] for name, values in station.tuning.all_gains().items()}


def test_several_controllers_change_in_one_cycle(station):
    changes = station.tuning.set_many({"one": {"k": 3.0}, "two": {"k": 4.0}})

    assert stiffness(station) == {"one": 3.0, "two": 4.0}
    assert changes["one"].cycle == changes["two"].cycle == station.loop.cycle
    assert changes["one"].previous == {"k": 2.0}
    assert station.tuning.gains("one").revision == changes["one"].revision


@pytest.mark.parametrize(
    ("changes", "error"),
    [
        ({"one": {"k": 3.0}, "two": {"k": 99.0}}, InvalidGainError),
        ({"one": {"k": 3.0}, "two": {"q": 1.0}}, InvalidGainError),
        ({"one": {"k": 3.0}, "three": {"k": 1.0}}, ControllerNotFoundError),
    ],
)
def test_one_impossible_value_leaves_all_as_they_were(station, changes, error):
    with pytest.raises(error):
        station.tuning.set_many(changes)

    assert stiffness(station) == {"one": 2.0, "two": 2.0}
    with pytest.raises(NothingToUndoError):
        station.tuning.undo()


def test_changes_are_taken_back_one_after_the_other(station):
    station.tuning.set_gains("one", {"k": 3.0})
    station.tuning.set_many({"one": {"k": 4.0}, "two": {"k": 5.0}})

    assert station.tuning.undo()["two"].values == {"k": 2.0}
    assert stiffness(station) == {"one": 3.0, "two": 2.0}
    assert station.tuning.undoable_changes == 1
    station.tuning.undo()
    assert stiffness(station) == {"one": 2.0, "two": 2.0}
    with pytest.raises(NothingToUndoError, match="No change"):
        station.tuning.undo()


def test_a_change_of_a_controller_that_was_loaded_anew_is_dropped(station):
    station.tuning.set_gains("two", {"k": 5.0})
    station.tuning.set_gains("one", {"k": 3.0})
    station.unload_controller("one")
    station.load_controller("one", "test/Spring", {"joint": "j", "k": 7.0})

    with pytest.raises(NothingToUndoError, match="'one'"):
        station.tuning.undo()
    station.tuning.undo()
    assert stiffness(station) == {"one": 7.0, "two": 2.0}


def test_only_the_latest_changes_are_remembered(station):
    for number in range(HISTORY + 5):
        station.tuning.set_gains("one", {"k": number / 1000.0})
    for _ in range(HISTORY):
        station.tuning.undo()
    with pytest.raises(NothingToUndoError):
        station.tuning.undo()
    assert stiffness(station)["one"] == 0.004


def test_a_gain_without_effect_is_told_with_the_change_and_the_controller():
    station = make_two_joint_station()
    kind = "effort_controllers/JointPositionController"
    pid = {"p": 1.0, "i": 5.0, "i_clamp": 1.0}
    station.load_controller("pid", kind, {"joint": "j1", "pid": pid})
    station.loop.step()
    assert station.controller("pid").notes == ()

    bounds = {"j1/i_clamp_max": 0.0, "j1/i_clamp_min": 0.0}
    (note,) = station.tuning.set_gains("pid", bounds).notes

    assert "'j1/i' is 5 and has no effect" in note
    assert station.controller("pid").notes == (note,)
    assert station.tuning.set_gains("pid", {"j1/i": 0.0}).notes == ()
