"""Gain sets on disk: saved, compared, applied, and what is wrong with them."""

import pytest

from station.core.errors import (
    ControllerNotFoundError,
    GainSetError,
    GainSetNotFoundError,
    InvalidGainError,
)
from station.library.gain_sets import GainSets, default_folder
from station.reports import GainDifference
from tests.api.spring import make_station


@pytest.fixture
def station():
    station = make_station()
    for name in ("one", "two"):
        station.load_controller(name, "test/Spring", {"joint": "j", "k": 2.0})
    station.loop.step()
    return station


@pytest.fixture
def sets(station, tmp_path):
    return GainSets(station.tuning, tmp_path / "sets")


def test_a_set_is_saved_and_found_again(station, sets):
    assert sets.names() == []
    saved = sets.save("soft")

    found = GainSets(station.tuning, sets.folder).get("soft")

    assert found == saved
    assert found.gains == {"one": {"k": 2.0}, "two": {"k": 2.0}}
    assert sets.names() == ["soft"]
    assert [path.name for path in sets.folder.iterdir()] == ["soft.yaml"]


def test_a_set_of_some_controllers_is_saved(sets):
    assert set(sets.save("soft", ["two"]).gains) == {"two"}
    with pytest.raises(ControllerNotFoundError):
        sets.save("soft", ["three"])
    assert set(sets.get("soft").gains) == {"two"}


def test_differences_are_those_to_the_gains_in_force(station, sets):
    sets.save("soft")
    assert sets.differences("soft") == []

    station.tuning.set_gains("one", {"k": 5.0})
    station.unload_controller("two")

    assert sets.differences("soft") == [
        GainDifference("one", "k", 2.0, 5.0),
        GainDifference("two", "k", 2.0, None),
    ]


def test_a_set_is_applied_whole_in_one_cycle(station, sets):
    sets.save("soft")
    for name in ("one", "two"):
        station.tuning.set_gains(name, {"k": 5.0})

    changes = sets.apply("soft")

    assert {change.cycle for change in changes.values()} == {station.loop.cycle}
    assert sets.differences("soft") == []
    station.tuning.undo()
    assert station.tuning.gains("two").values == {"k": 5.0}


def test_some_controllers_of_a_set_are_applied(station, sets):
    sets.save("soft")
    for name in ("one", "two"):
        station.tuning.set_gains(name, {"k": 5.0})

    sets.apply("soft", ["two"])

    assert station.tuning.gains("one").values == {"k": 5.0}
    assert station.tuning.gains("two").values == {"k": 2.0}
    with pytest.raises(InvalidGainError, match="no gains of controller 'three'"):
        sets.apply("soft", ["three"])


def test_a_set_of_a_controller_that_is_not_loaded_changes_nothing(station, sets):
    sets.save("soft")
    station.tuning.set_gains("one", {"k": 5.0})
    station.unload_controller("two")

    with pytest.raises(ControllerNotFoundError):
        sets.apply("soft")
    assert station.tuning.gains("one").values == {"k": 5.0}


def test_a_set_is_deleted(sets):
    sets.save("soft")
    sets.delete("soft")

    assert sets.names() == []
    with pytest.raises(GainSetNotFoundError):
        sets.delete("soft")


@pytest.mark.parametrize(
    "name", ["", "..", "../x", "a/b", ".x", "x" * 101, "a b", "a\0"]
)
def test_names_never_lead_out_of_the_folder(sets, name):
    for use in (sets.get, sets.save, sets.delete, sets.apply):
        with pytest.raises(GainSetNotFoundError):
            use(name)
    assert not sets.folder.parent.joinpath("x.yaml").exists()


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "valid dictionary"),
        ("gains: 5", "valid dictionary"),
        ("gains: {one: 5}", "one: Input should be a valid dictionary"),
        ("gains: {one: {k: high}}", "one/k: Input should be a valid number"),
        ("gains: {one: {k: .nan}}", "one/k: Input should be a finite number"),
        ("gains: {one: {k: true}}", "one/k: Input should be a valid number"),
        ("{", "not valid YAML"),
        ("gains: !!python/object/apply:os.getcwd []", "unknown"),
        ("#" * 1_000_001, "larger than"),
    ],
)
def test_a_malformed_file_is_refused_with_its_name(sets, text, why):
    sets.save("soft")
    (sets.folder / "soft.yaml").write_text(text)

    with pytest.raises(GainSetError, match=why) as caught:
        sets.apply("soft")
    assert "soft.yaml" in caught.value.message


def test_a_folder_that_cannot_be_written_is_told(station, tmp_path):
    (tmp_path / "file").write_text("")

    with pytest.raises(GainSetError, match="file"):
        GainSets(station.tuning, tmp_path / "file" / "sets").save("soft")


def test_without_a_folder_the_users_own_is_used(station, monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))

    GainSets(station.tuning).save("soft")

    assert default_folder() == tmp_path / "control-station" / "gain-sets"
    assert (default_folder() / "soft.yaml").exists()
