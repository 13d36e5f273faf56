"""Requests of the page about its own 3D view."""

import httpx
import pytest
from starlette.applications import Starlette

from station.ui.page.view_routes import ShownViews, ViewRoutes
from station.ui.scene.scene_views import Ghost
from station.ui.sessions.sessions import Role, Sessions
from tests.ui.served import Served


class _Views:
    """Stands for what the sessions see."""

    def __init__(self):
        self.ghosts = {}
        self.chosen = []

    def joint_names(self):
        return frozenset({"joint1", "joint2"})

    def show_ghost(self, key, ghost):
        self.ghosts[key] = ghost

    def choose(self, key, layers):
        self.chosen.append((key, layers))

    def paint(self, key, *, is_dark):
        self.chosen.append((key, is_dark))

    def look(self, key, preset, covered):
        self.chosen.append((key, preset, covered))

    def opened(self, key, covered):
        self.chosen.append((key, covered))


class _Bench:
    def __init__(self):
        self.views = _Views()
        self.session = None
        shown = ShownViews(self.views, lambda call: call())
        self.routes = ViewRoutes(shown, lambda _: self.session).routes()


@pytest.fixture(scope="module")
def served():
    bench = _Bench()
    with Served(Starlette(routes=bench.routes)) as gateway:
        yield bench, gateway.url


@pytest.fixture
def bench(served):
    bench = served[0]
    bench.views.ghosts.clear()
    bench.views.chosen.clear()
    bench.session = Sessions().open(Role.VIEWER)
    return bench


@pytest.fixture
def browser(served, bench):
    assert bench.session is not None
    with httpx.Client(base_url=served[1]) as client:
        yield client


def test_a_ghost_is_shown_to_the_session_that_asks_and_hidden_again(browser, bench):
    body = {"positions": {"joint1": 0.5}, "label": "recorded"}
    assert browser.post("/ui/ghost", json=body).status_code == 200
    assert bench.views.ghosts == {bench.session.key: Ghost({"joint1": 0.5}, "recorded")}
    assert browser.delete("/ui/ghost").json() == {"shown": False}
    assert bench.views.ghosts == {bench.session.key: None}


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ({"positions": {"elbow": 0.5}}, "positions.elbow"),
        ({"positions": {}}, "positions: Dictionary should have at least 1 item"),
        ({"positions": {"joint1": "far"}}, "positions.joint1: Input should be a valid"),
        ({"positions": {"joint1": 0.1}, "colour": "red"}, "colour: Extra inputs"),
        ([], "the body"),
    ],
)
def test_a_wrong_ghost_is_refused_and_changes_nothing(browser, bench, body, reason):
    answer = browser.post("/ui/ghost", json=body)
    assert answer.status_code == 422
    assert reason in answer.json()["detail"]
    assert bench.views.ghosts == {}


def test_nothing_is_shown_without_a_session(browser, bench):
    bench.session = None
    body = {"positions": {"joint1": 0.5}}
    assert browser.post("/ui/ghost", json=body).status_code == 401
    assert browser.delete("/ui/ghost").status_code == 401
    assert browser.put("/ui/layers", json={"shown": []}).status_code == 401
    assert browser.post("/ui/camera", json={"preset": "fit"}).status_code == 401
    assert browser.put("/ui/scheme", json={"dark": True}).status_code == 401
    assert browser.post("/ui/opened", json={"covered": 0.0}).status_code == 401
    assert (bench.views.ghosts, bench.views.chosen) == ({}, [])


def test_layers_camera_and_colours_are_those_of_the_session_that_asks(browser, bench):
    browser.put("/ui/layers", json={"shown": ["frames"]}).raise_for_status()
    camera = {"preset": "hand", "covered": 0.25}
    browser.post("/ui/camera", json=camera).raise_for_status()
    browser.put("/ui/scheme", json={"dark": True}).raise_for_status()
    browser.post("/ui/opened", json={"covered": 0.5}).raise_for_status()
    key = bench.session.key
    assert bench.views.chosen == [
        (key, ["frames"]),
        (key, "hand", 0.25),
        (key, True),
        (key, 0.5),
    ]


@pytest.mark.parametrize(
    ("method", "path", "body", "reason"),
    [
        (
            "PUT",
            "layers",
            {"shown": ["walls"]},
            "no layer 'walls'; choose among command",
        ),
        ("PUT", "layers", {}, "shown: Field required"),
        ("PUT", "scheme", {"dark": "yes"}, "dark: Input should be a valid boolean"),
        ("POST", "camera", {"preset": "moon"}, "no 'moon'; choose among fit, front"),
        (
            "POST",
            "camera",
            {"preset": "fit", "covered": 1.0},
            "covered: Input should be",
        ),
        ("POST", "camera", {"preset": 1}, "preset: Input should be a valid string"),
        ("POST", "opened", {"covered": 0.9}, "covered: Input should be less than"),
    ],
)
def test_what_there_is_not_is_refused_with_what_there_is(
    browser, bench, method, path, body, reason
):
    answer = browser.request(method, f"/ui/{path}", json=body)
    assert answer.status_code == 422
    assert reason in answer.json()["detail"]
    assert bench.views.chosen == []
