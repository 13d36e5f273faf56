"""Two browsers at one station: one operates; the other watches, stops, takes over.

An agent asks there, too, and the page answers it.
"""

from concurrent.futures import ThreadPoolExecutor

import httpx
import pytest

from tests.browser.conftest import logged_in
from tests.browser.workspace_page import (
    CONTROLLER,
    OTHER,
    WorkspacePage,
    let_pass,
    position,
    wait_until,
    without_scene,
)

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def watching(browser, running_station):
    """A second browser, with a login of its own."""
    with logged_in(browser, running_station, begin=without_scene) as page:
        yield WorkspacePage(page)


@pytest.fixture
def ada(workspace, enabled, in_control):
    """The first browser; it holds control as ada, and its controller runs."""
    assert in_control is enabled
    return workspace


def _note(workspace):
    """Return what the line over the 3D view says of who holds control."""
    return workspace.page.locator("#watching")


def test_the_other_browser_is_told_that_it_only_watches(ada, watching, enabled):
    _note(watching).get_by_text(
        "ada holds control: here you only watch. STOP works."
    ).wait_for()
    assert not _note(ada).is_visible()
    assert not ada.page.locator("#refusal-line").is_visible()
    note = _note(watching).bounding_box()
    view = watching.page.locator("#scene").bounding_box()
    assert view["x"] <= note["x"]
    assert note["x"] + note["width"] <= view["x"] + view["width"]
    assert enabled.lease.state().owner == "ada"


def test_two_people_move_different_joints_and_the_later_one_the_same_joint(
    workspace, watching, enabled
):
    ada, grace = workspace, watching
    for one in (ada, grace):
        one.page.wait_for_function(
            "() => !document.querySelector('.joints input').disabled"
        )
        one.button("joints", "rad").click()
    ada.type_into("joints", "Command of joint1", "0.9")
    grace.type_into("joints", "Command of joint7", "1.5")
    assert wait_until(
        lambda: (
            abs(position(enabled, "panda_joint1") - 0.9) < 0.02
            and abs(position(enabled, "panda_joint7") - 1.5) < 0.02
        )
    )
    ada.type_into("joints", "Command of joint1", "-0.9")
    assert wait_until(lambda: position(enabled, "panda_joint1") < 0.8)
    grace.type_into("joints", "Command of joint1", "0.9")
    ada.page.locator("#refusal-line").get_by_text("Somebody else moves").wait_for()
    assert wait_until(lambda: abs(position(enabled, "panda_joint1") - 0.9) < 0.02)
    assert not grace.page.locator("#refusal-line").is_visible()


def test_what_the_watching_browser_asks_for_is_refused_with_the_name(
    ada, watching, enabled
):
    before = enabled.last_command(CONTROLLER).last
    watching.button("joints", "rad").click()
    watching.type_into("joints", "Command of joint1", "0.4")
    line = watching.page.locator("#refusal-line")
    line.get_by_text("ada holds control").wait_for()
    start = watching.button("controllers", f"Start {OTHER}")
    assert wait_until(start.is_disabled)
    _note(watching).get_by_role("button", name="Take control …").click()
    panel = watching.page.locator("#control-panel")
    panel.get_by_text("Take control away from ada?").wait_for()
    panel.get_by_role("button", name="No", exact=True).click()
    assert enabled.last_command(CONTROLLER).last == before
    ada.button("joints", "rad").click()
    ada.type_into("joints", "Command of joint1", "0.1")
    assert wait_until(lambda: abs(position(enabled, "panda_joint1") - 0.1) < 0.02)


def test_what_one_browser_moves_the_other_sees(ada, watching, enabled):
    ada.button("joints", "rad").click()
    watching.button("joints", "rad").click()
    ada.type_into("joints", "Command of joint1", "-0.2")
    assert wait_until(lambda: abs(position(enabled, "panda_joint1") + 0.2) < 0.02)
    watching.page.wait_for_function(
        "() => Math.abs(Number(document.querySelector('.joints tbody td:nth-child(2)')"
        ".textContent) + 0.2) < 0.02"
    )


def test_taking_over_in_the_middle_of_a_jog_stops_the_jog(ada, watching, enabled):
    page = ada.page
    ada.button("joints", "Move joint7 up while held").hover()
    page.mouse.down()
    before = position(enabled, "panda_joint7")
    assert wait_until(lambda: position(enabled, "panda_joint7") > before + 0.05)
    other = watching.page
    other.locator("#control").click()
    panel = other.locator("#control-panel")
    panel.get_by_role("button", name="Take it by force …").click()
    panel.get_by_label("Your name").fill("grace")
    panel.get_by_role("button", name="Yes, take it from ada").click()
    assert wait_until(lambda: enabled.lease.state().owner == "grace")
    rest = enabled.last_command(CONTROLLER).last
    _note(ada).get_by_text("grace holds control: here you only watch").wait_for()
    ada.page.locator("#refusal-line").get_by_text("grace").first.wait_for()
    assert not _note(watching).is_visible()
    assert let_pass(enabled, 0.5)
    assert enabled.last_command(CONTROLLER).last == rest  # The button is still held.
    page.mouse.up()


def test_the_watching_browser_stops_the_robot(ada, watching, enabled):
    watching.page.locator("#stop").click()
    assert wait_until(lambda: enabled.status().stop_state == "stopped")
    ada.page.locator("#motion").get_by_text("STOPPED").wait_for()
    bar = ada.page.locator("#bar")
    bar.get_by_role("button", name="Release stop").click()
    bar.get_by_role("button", name="Allow motion").click()
    assert wait_until(lambda: enabled.status().stop_state == "armed")


@pytest.fixture(scope="module")
def agent(running_station):
    """A client of an agent."""
    url = f"{running_station.api}/api/v1"
    given = {"name": "tuner", "role": "agent"}
    operator = {"Authorization": f"Bearer {running_station.token}"}
    answer = httpx.post(f"{url}/tokens", json=given, headers=operator)
    secret = answer.raise_for_status().json()["token"]
    bearer = {"Authorization": f"Bearer {secret}"}
    with httpx.Client(base_url=url, headers=bearer, timeout=40) as client:
        yield client


@pytest.mark.parametrize(
    ("click", "status", "runs"), [("Refuse", 403, CONTROLLER), ("Allow", 200, OTHER)]
)
def test_a_click_answers_what_an_agent_asks_for(
    workspace, enabled, agent, click, status, runs
):
    agent.post("/control", json={"ttl": 60.0}).raise_for_status()
    wanted = {"start": [OTHER], "stop": [CONTROLLER]}
    with ThreadPoolExecutor(1) as thread:
        asked = thread.submit(agent.post, "/controllers/switch", json=wanted)
        card = workspace.page.get_by_label("Request of tuner")
        card.get_by_text("tuner asks for").wait_for()
        assert OTHER in card.locator("pre").text_content()
        card.get_by_text("It would be completed in").wait_for()
        assert not asked.done()
        assert enabled.controller(CONTROLLER).state == "running"
        card.get_by_role("button", name=click, exact=True).click()
        answer = asked.result(20)
    assert answer.status_code == status, answer.text
    card.wait_for(state="detached")
    assert enabled.controller(runs).state == "running"
