"""The things around a simulated robot, drawn and moved."""

import pytest
import trimesh

from station.ui.scene.scene_objects import SceneObjects
from station.wire import SceneObject


def thing(name="cube", kind="box", size=(0.1, 0.1, 0.1), **values):
    """Return a thing at the origin."""
    values = {
        "position": [0.0, 0.0, 0.0],
        "orientation": [0.0, 0.0, 0.0, 1.0],
        "mass": 0.1,
        **values,
    }
    return SceneObject(name=name, type=kind, size=list(size), **values)


@pytest.fixture
def objects(shared_bench):
    objects = SceneObjects(shared_bench.guarded.server)
    yield objects
    objects.show([])


@pytest.mark.parametrize(
    ("kind", "size"),
    [
        ("box", (0.1, 0.2, 0.3)),
        ("table", (1.0, 1.0, 0.4)),
        ("sphere", (0.1,)),
        ("cylinder", (0.1, 0.2)),
    ],
)
def test_each_kind_of_object_is_drawn_at_its_pose(objects, kind, size):
    half = 0.5**0.5
    objects.show([
        thing("a", kind, size, position=[1.0, 2.0, 3.0], orientation=[half, 0, 0, half])
    ])

    handle = objects.handles["a"]
    assert tuple(handle.position) == (1.0, 2.0, 3.0)
    assert tuple(handle.wxyz) == pytest.approx((half, half, 0.0, 0.0))


def test_a_mesh_is_read_from_its_file(objects, tmp_path):
    file = tmp_path / "pyramid.stl"
    trimesh.creation.cone(0.1, 0.2).export(file)

    objects.show([thing("cone", "mesh", (), file=str(file))])

    assert len(objects.handles["cone"].faces) > 0


def test_a_mesh_on_another_machine_is_shown_by_its_name(objects):
    objects.show([thing("cone", "mesh", (), file="/nowhere/cone.stl")])

    assert "cone" in objects.handles["cone"].text


def test_a_moved_object_is_moved_and_a_missing_object_is_removed(objects):
    objects.show([thing("a"), thing("b")])
    handle = objects.handles["a"]

    objects.show([thing("a", position=[0.5, 0.0, 0.0])])

    assert tuple(handle.position) == (0.5, 0.0, 0.0)
    assert set(objects.handles) == {"a"}


def test_an_object_that_moves_by_a_rounding_error_is_not_sent_again(
    objects, shared_bench, monkeypatch
):
    objects.show([thing("a")])
    sent = []
    server = shared_bench.guarded.server
    monkeypatch.setattr(server._websock_server, "queue_message", sent.append)

    objects.show([thing("a", position=[1e-9, 0.0, 0.0])])

    assert sent == []
