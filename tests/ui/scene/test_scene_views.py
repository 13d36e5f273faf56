"""The views of browser sessions."""

import numpy as np
import pytest

from station.ui.scene.layers.drag_layers import Pushing
from station.ui.scene.layers.layer import PlacedRobot, SceneFacts
from station.ui.scene.robot_model import load_robot
from station.ui.scene.scene_views import AT_FIRST, Ghost, SceneViews

PUSHING = Pushing(None, None)
RECORDED = Ghost({"panda_joint1": 0.5}, "recorded, 3.2 s")


@pytest.fixture(scope="module")
def panda():
    return load_robot("example-robot-data:panda")


@pytest.fixture
def start(client):
    """Return where cameras are at first [m]; the client's is there."""
    client.camera.position = (3.0, 0.0, 1.0)
    client.camera.look_at = (0.0, 0.0, 0.5)
    return [3.0, 0.0, 1.0]


@pytest.fixture
def views(panda, client, start):
    views = SceneViews(
        [PlacedRobot(panda, "/robot")], lambda _: "mine", PUSHING, lambda: start
    )
    views.joined(client)
    yield views
    views.choose("mine", ())
    views.show_ghost("mine", None)


def _ghost(client):
    return client.scene.get_handle_by_name("/ghost_0")


def test_a_ghost_is_shown_in_the_browsers_of_its_session_alone(views, client):
    views.show_ghost("somebody else's", RECORDED)
    assert _ghost(client) is None
    views.show_ghost("mine", RECORDED)
    assert _ghost(client).visible
    label = client.scene.get_handle_by_name("/ghost_label")
    assert (label.text, label.visible) == (RECORDED.label, True)


def test_a_ghost_is_hidden_with_its_label(views, client):
    views.show_ghost("mine", RECORDED)
    views.show_ghost("mine", None)
    assert not _ghost(client).visible
    assert not client.scene.get_handle_by_name("/ghost_label").visible


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


COLLISION = "/robot/panda_link0/panda_link1/collision"


def test_a_layer_is_drawn_for_the_session_that_chose_it_while_it_does(views, client):
    views.choose("somebody else's", ["collision"])
    assert client.scene.get_handle_by_name(COLLISION) is None
    views.choose("mine", ["collision"])
    assert client.scene.get_handle_by_name(COLLISION) is not None
    assert views.wanted() == {"collision"}
    views.choose("mine", [])
    assert client.scene.get_handle_by_name(COLLISION) is None
    assert views.wanted() == frozenset()


def test_a_session_that_has_not_chosen_sees_what_matters(views):
    assert views.wanted() == AT_FIRST


def test_a_choice_outlives_the_browser(views, client):
    views.choose("mine", ["collision"])
    views.left(client)
    assert views.wanted() == frozenset()
    views.joined(client)
    assert views.wanted() == {"collision"}


def test_a_browser_of_the_session_looks_from_another_place(views, client):
    views.refresh(SceneFacts(positions={}))
    views.look("somebody else's", "top")
    before = tuple(client.camera.position)
    views.look("mine", "top")
    assert tuple(client.camera.position) != before
    x, y, z = client.camera.position - client.camera.look_at
    assert z > 10.0 * abs(x)
    assert abs(y) < 1e-9


def test_only_the_page_of_a_session_keeps_its_push_alive(views, client):
    views.choose("mine", ["push"])
    assert client.scene.get_handle_by_name("/robot/panda_link0/push") is not None
    views.alive("somebody else's")
    views.alive("mine")
    views.left(client)
    assert client.scene.get_handle_by_name("/robot/panda_link0/push") is None


def test_a_view_is_as_dark_as_its_page_also_after_it_connects_again(
    views, client, monkeypatch
):
    painted = []

    def paint(browser, *, is_dark):
        painted.append((browser.client_id, is_dark))

    monkeypatch.setattr("station.ui.scene.scene_views.paint", paint)
    views.paint("somebody else's", is_dark=True)
    assert painted == []
    views.paint("mine", is_dark=True)
    views.left(client)
    views.joined(client)
    views.paint("mine", is_dark=False)
    here = client.client_id
    assert painted == [(here, True), (here, True), (here, False)]


AT_ZERO = SceneFacts(positions={"panda_joint1": 0.0})


def _sideways(client):
    """Return how far the robot's axis is right of the middle of the picture [m]."""
    x, y, _ = client.camera.position - client.camera.look_at
    right = np.array([-y, x]) / np.hypot(x, y)
    return float(-right @ np.array(client.camera.look_at)[:2])


def test_the_robot_is_seen_beside_what_the_page_hides_when_it_opens(
    views, client, start
):
    views.refresh(AT_ZERO)
    views.opened("mine", 0.0)
    in_the_middle = _sideways(client)
    views.left(client)
    start[:] = client.camera.position
    views.opened("mine", 0.4)
    views.joined(client)
    assert _sideways(client) > in_the_middle + 0.1


def test_a_page_that_opens_before_the_robot_is_known_waits_for_it(views, client):
    before = tuple(client.camera.position)
    views.opened("mine", 0.4)
    assert tuple(client.camera.position) == before
    views.refresh(AT_ZERO)
    assert tuple(client.camera.position) != before


def test_a_camera_that_was_moved_stays_where_it_is(views, client):
    client.camera.position = client.camera.position + np.array([0.1, 0.0, 0.0])
    moved = tuple(client.camera.position)
    views.opened("mine", 0.4)
    views.refresh(AT_ZERO)
    assert tuple(client.camera.position) == moved


def test_a_page_that_has_not_read_yet_where_it_begins_is_framed_once_it_has(
    views, client, start
):
    client.camera.position = (3.0, 3.0, 3.0)
    views.opened("mine", 0.4)
    views.refresh(AT_ZERO)
    assert tuple(client.camera.position) == (3.0, 3.0, 3.0)
    client.camera.position = start
    views.refresh(AT_ZERO)
    assert tuple(client.camera.position) != tuple(start)


def test_a_camera_is_framed_once(views, client, start):
    views.refresh(AT_ZERO)
    views.opened("mine", 0.4)
    framed = tuple(client.camera.position)
    start[:] = framed
    views.opened("mine", 0.1)
    assert tuple(client.camera.position) == framed
