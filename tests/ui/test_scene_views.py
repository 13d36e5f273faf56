"""What each browser session sees in the 3D view."""

import pytest

from station.ui.robot_model import load_robot
from station.ui.scene_views import Ghost, SceneViews

RECORDED = Ghost({"panda_joint1": 0.5}, "recorded, 3.2 s")


@pytest.fixture(scope="module")
def panda():
    return load_robot("example-robot-data:panda")


@pytest.fixture
def client(shared_bench):
    return next(iter(shared_bench.guarded.server.get_clients().values()))


@pytest.fixture
def views(panda, client):
    views = SceneViews([panda], lambda _: "mine")
    views.joined(client)
    yield views
    views.show_ghost("mine", None)


def _ghost(client):
    return client.scene.get_handle_by_name("/ghost_0")


def test_a_ghost_is_shown_in_the_browsers_of_its_session_alone(views, client):
    views.show_ghost("somebody else's", RECORDED)
    assert _ghost(client) is None
    views.show_ghost("mine", RECORDED)
    assert _ghost(client).visible
    assert client.scene.get_handle_by_name("/ghost_label").text == RECORDED.label


def test_a_ghost_is_hidden_with_its_label(views, client):
    views.show_ghost("mine", RECORDED)
    views.show_ghost("mine", None)
    assert not _ghost(client).visible
    assert client.scene.get_handle_by_name("/ghost_label") is None


def test_a_browser_that_connects_again_sees_its_ghost(views, client):
    views.left(client)
    views.show_ghost("mine", RECORDED)
    views.joined(client)
    assert _ghost(client).visible


def test_the_label_is_above_the_ghost(views, client, panda):
    straight = Ghost({"panda_joint4": 0.0}, "straight")
    views.show_ghost("mine", straight)
    height = client.scene.get_handle_by_name("/ghost_label").position[2]
    assert height > panda.bounds(straight.positions)[1, 2] > 1.0


def test_a_ghost_has_the_joints_that_move(views):
    names = views.joint_names()
    assert {"panda_joint1", "panda_finger_joint1"} <= names
    assert "panda_hand_joint" not in names
