"""Things in the world come from the configuration."""

import mujoco
import pytest

from station.core.errors import ParameterError
from station.core.geometry.scene import read_object, read_scene
from station.core.parameters import Parameters, ParameterTree
from station.hw.mujoco.model_builder import add_object, compile_world, new_world

TABLE = {
    "name": "table",
    "type": "table",
    "size": [1, 1, 0.4],
    "position": [0.5, 0, 0.4],
}
BALL = {"name": "ball", "type": "sphere", "size": [0.05], "mass": 0.2}


def build(*entries):
    spec = new_world(0.001)
    for entry in entries:
        add_object(spec, read_object(entry, "x"))
    model = compile_world(spec)
    data = mujoco.MjData(model)
    return model, data


def test_ball_falls_onto_the_table_and_stays_there():
    model, data = build(TABLE, {**BALL, "position": [0.5, 0, 0.6]})
    for _ in range(2_000):
        mujoco.mj_step(model, data)
    assert data.body("ball").xpos[2] == pytest.approx(0.45, abs=2e-3)
    assert data.body("table").xpos[2] == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"type": "cone"}, "type' is 'cone'; it must be one of"),
        ({"size": [0.1, 0.1]}, "size' is .* it must be 1 finite"),
        ({"size": [-0.1]}, "it must be above 0"),
        (
            {"size": [1e300]},
            "it must be above 0, and 1000 m at most",
        ),
        ({"position": [0, -1e6, 0]}, "position' is .* it must be within 1000 m"),
        ({"mass": -1.0}, "it must be 0 or more"),
        ({"mass": 1e308}, "it must be 0 or more, 1e.06 kg and 100 at most"),
        ({"friction": 1e308}, "it must be 0 or more, 1e.06 kg and 100 at most"),
        ({"file": "ball.stl"}, "file' is 'ball.stl'; it must be left out"),
        ({"texture": "wood"}, "with keys of"),
        ({"colour": "red"}, "must be 3 finite"),
        ({"colour": [1.5, 0, 0]}, "whole numbers from 0 to 255"),
        ({"role": "wall"}, "one of .*keep_out"),
        ({"role": "fence", "mass": 1.0}, "a fence stays where it is"),
        ({"margin": -0.01}, "0 to 1000 m"),
        ({"margin": 1e308}, "0 to 1000 m"),
        ({"links": "hand"}, "a list of names"),
        ({"name": ""}, "name' is ''"),
        ({"name": "a\nb"}, "must be a name of printable characters"),
        ({"type": "mesh", "size": []}, "path of a mesh file"),
    ],
)
def test_impossible_thing_is_refused(change, problem):
    with pytest.raises(ParameterError, match=problem):
        read_object({**BALL, **change}, "scene/objects/0")


def test_names_are_unlike():
    tree = ParameterTree({"scene": {"objects": [BALL, BALL]}})
    with pytest.raises(ParameterError, match="unlike names"):
        read_scene(Parameters(tree))
    assert read_scene(Parameters(ParameterTree({}))) == []


@pytest.mark.parametrize(
    ("name", "size", "problem"),
    [("hull", 10, "has no extension"), ("hull.stl", 3_000_000_000, "3000000000 bytes")],
)
def test_file_that_is_no_mesh_is_refused_with_its_key(tmp_path, name, size, problem):
    path = tmp_path / name
    with path.open("wb") as file:
        file.truncate(size)
    entry = {"name": "hull", "type": "mesh", "file": str(path)}
    with pytest.raises(ParameterError, match=problem) as caught:
        read_object(entry, "scene/objects/0")
    assert "'scene/objects/0/file'" in caught.value.message
