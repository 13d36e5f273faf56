"""The verb that changes the objects around robots."""

import json
from types import SimpleNamespace

import pytest

from station.wire import SavedScene, SceneObject

CUBE = SceneObject(
    name="cube",
    type="box",
    size=[0.05] * 3,
    position=[0.5, 0.0, 0.1],
    orientation=[0.0, 0.0, 0.0, 1.0],
    mass=0.1,
)


@pytest.fixture
def asked(station):
    """Return what was asked of the station."""
    found = []

    def answer(name, result):
        def call(*arguments, **options):
            found.append((name, *arguments, options))
            return result

        return call

    held = CUBE.model_copy(update={"carried_by": "panda"})
    saved = SavedScene("cell", "2026-11-26T05:00:00", [{"name": "cube"}])
    station.attach_object = answer("attach", held)
    station.detach_object = answer("detach", CUBE)
    station.scene = answer("scene", [held])
    station.clearances = answer("clearances", [])
    store = {name: answer(name, saved) for name in ("save", "load", "delete")}
    station.scenes = SimpleNamespace(**store, names=answer("names", ["cell"]))
    return found


def test_an_object_is_attached_and_detached(run, asked):
    attached = run("scene attach cube arm=panda load=no")
    assert "'cube' is a box with the role object, carried by panda." in attached.out
    assert "carried" not in run("scene detach cube").out
    assert asked == [
        ("attach", "cube", "panda", {"load": False}),
        ("detach", "cube", {"load": True}),
    ]


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        ("attach cube arm=panda load=false", "load is 'false'"),
        ("attach cube amr=panda", "has no key 'amr'"),
        ("detach cube arm=panda", "has no key 'arm'"),
    ],
)
def test_an_unknown_word_of_attach_is_refused(run, asked, words, reason):
    outcome = run(f"scene {words}")

    assert (outcome.code, asked) == (2, [])
    assert reason in outcome.err


def test_scenes_are_saved_listed_loaded_and_deleted(run, asked):
    assert "'cell' with 1 object is saved" in run("scene save cell").out
    assert run("scene saved").out == "cell\n"
    loaded = run("scene load cell").out
    assert loaded == "cube: box, object, at 0.500, 0.000, 0.100 m, carried by panda\n"
    assert "is deleted" in run("scene delete cell").out
    assert [one[0] for one in asked if one[1:2] == ("cell",)] == [
        "save", "load", "delete",
    ]  # fmt: skip


def test_a_name_is_needed(run, asked):
    outcome = run("scene attach")
    assert (outcome.code, asked) == (2, [])


@pytest.mark.parametrize("objects", [[], [CUBE], [CUBE, CUBE]])
def test_the_scene_is_one_json_list(run, station, objects):
    station.scene = lambda: objects

    found = json.loads(run("scene --json").out)

    assert [one["name"] for one in found] == ["cube"] * len(objects)


def test_put_refuses_what_only_the_configuration_has(run, asked):
    outcome = run("scene put cube mass=3")

    assert (outcome.code, asked) == (2, [])
    assert "`scene put` has no key 'mass'" in outcome.err
