"""The dashboard in a real browser, at a real station."""

import pytest

from station.wire import Fault
from tests.browser.conftest import keep_screenshot
from tests.browser.viser_page import ViserPage
from tests.browser.workspace_page import run_alone, wait_until

pytestmark = pytest.mark.long

CONTROLLER = "effort_group_position_controller"


TRIANGLES = "() => window.__viserTestpoints.rendererInfo.render.triangles"


def _position(client, joint):
    joints = client.joint_states()
    return joints.position[joints.name.index(joint)]


def _state(client, name):
    return client.controller(name).state


@pytest.fixture
def scene(page):
    """What Viser draws, with the robot in it."""
    view = ViserPage(page)
    view.wait_for_scene()
    return view.frame


@pytest.fixture
def idle(client):
    """Nothing that moves the arm runs, before and after."""
    yield client
    run_alone(client)


def test_nothing_is_shown_before_login(browser, running_station):
    page = browser.new_page()
    page.goto(running_station.ui)
    assert page.url.endswith("/login")
    assert page.locator("#view").count() == 0
    page.get_by_label("Token").fill("wrong")
    page.get_by_role("button", name="Log in").click()
    assert "not a token of this station" in page.get_by_role("alert").inner_text()
    page.close()


def test_login_leaves_no_token_in_the_address(page, running_station):
    assert page.url == f"{running_station.ui}/"
    page.wait_for_selector('#bar[data-link="live"]')
    assert page.locator("#rate").inner_text().endswith("Hz")


def _press(page, name):
    """Click a tool; drawn in software, the page is too slow to be waited for."""
    tools = page.locator("#view-tools")
    tools.get_by_role("button", name=name, exact=True).dispatch_event("click")


def test_a_link_is_pulled_with_the_pointer(page, scene, idle):
    page.get_by_role("button", name="Skip the tour").dispatch_event("click")
    page.wait_for_function("() => document.getElementById('progress').hidden")
    _press(page, "Fit")
    before = scene.evaluate(TRIANGLES)
    _press(page, "Push")
    scene.wait_for_function(f"n => ({TRIANGLES})() > n", arg=before)
    view = page.locator("#view").bounding_box()
    since = idle.events(limit=1)[-1].id

    def pushes():
        what = "POST /robots/panda/external_force"
        found = idle.events(since, kinds=["request"], limit=1000)
        return [e.result for e in found if e.what == what]

    # The elbow, where the robot is fitted beside the tools.
    x = view["x"] + view["width"] / 2 + 0.11 * view["height"]
    y = view["y"] + 0.35 * view["height"]
    page.mouse.move(x, y)
    page.mouse.down()
    for step in range(1, 8):
        page.mouse.move(x + 12 * step, y - 4 * step)
    pulled = wait_until(lambda: pushes() and "200" in pushes()[0])
    keep_screenshot(page, "dashboard_pull.png")
    page.mouse.up()
    assert pulled
    panda = idle.robot("panda")
    assert wait_until(lambda: max(map(abs, panda.state().O_F_ext_hat_K)) < 10.0)
    _press(page, "Push")


def test_a_ghost_is_drawn_beside_the_robot_and_removed(page, scene):
    before = scene.evaluate(TRIANGLES)
    pose = "{method: 'POST', headers: {'Content-Type': 'application/json'}, body: "
    pose += "JSON.stringify({positions: {panda_joint1: 1.2}, label: 'planned'})}"
    page.evaluate(f"() => fetch('/ui/ghost', {pose})")
    scene.wait_for_function(f"n => ({TRIANGLES})() > n", arg=before)
    # There is something to be seen where the other tests only count.
    assert keep_screenshot(page, "dashboard_ghost.png") > 100
    shown = scene.evaluate(TRIANGLES)
    page.evaluate("() => fetch('/ui/ghost', {method: 'DELETE'})")
    scene.wait_for_function(f"n => ({TRIANGLES})() < n", arg=shown)


def test_the_tools_of_the_view_turn_the_camera_and_lay_layers_over_the_robot(
    page, scene
):
    with page.expect_response("**/ui/camera") as answer:
        _press(page, "Front")
    assert answer.value.json() == {"preset": "front"}
    before = scene.evaluate(TRIANGLES)
    with page.expect_response("**/ui/layers") as answer:
        _press(page, "Collision")
    assert "collision" in answer.value.json()["shown"]
    scene.wait_for_function(f"n => ({TRIANGLES})() > n", arg=before)
    _press(page, "Collision")
    scene.wait_for_function(f"n => ({TRIANGLES})() <= n", arg=before)


def test_a_slider_moves_the_joint_that_it_follows(page, viser_page, idle):
    before = _position(idle, "panda_joint1")
    idle.switch_controllers(start=[CONTROLLER])
    viser_page.open_tab("Joints")
    viser_page.frame.get_by_text(f"Sliders command {CONTROLLER}").wait_for()
    assert _position(idle, "panda_joint1") == pytest.approx(before, abs=2e-3)
    viser_page.drag_slider("joint1 [rad]", 0.62)
    assert wait_until(lambda: _position(idle, "panda_joint1") > before + 0.4)
    keep_screenshot(page, "dashboard_sliders.png")


def test_a_gain_slider_changes_the_gain(page, viser_page, idle):
    idle.switch_controllers(start=[CONTROLLER])
    name = "panda_joint1/p"
    before = idle.gains(CONTROLLER).values[name]
    viser_page.open_tab("Gains")
    viser_page.frame.get_by_text("p [Nm/rad]").wait_for()
    viser_page.drag_slider("p [Nm/rad]", 0.15)
    assert wait_until(lambda: idle.gains(CONTROLLER).values[name] < before)
    keep_screenshot(page, "dashboard_gains.png")
    idle.set_gains(CONTROLLER, {name: before})


@pytest.mark.usefixtures("idle")
def test_greyed_sliders_say_why(viser_page):
    viser_page.open_tab("Joints")
    viser_page.frame.get_by_text("nothing that runs takes set-points").wait_for()
    viser_page.row("joint1 [rad]").locator("[data-disabled]").first.wait_for()


def test_a_refusal_is_shown_as_the_station_words_it(page, viser_page, idle):
    idle.switch_controllers(start=[CONTROLLER])
    viser_page.open_tab("Joints")
    viser_page.frame.get_by_text(f"Sliders command {CONTROLLER}").wait_for()
    before = _position(idle, "panda_joint1")
    with idle.control(owner="ada"):
        viser_page.drag_slider("joint1 [rad]", 0.3)
        page.locator("#messages").get_by_text("ada").first.wait_for()
    assert _position(idle, "panda_joint1") == pytest.approx(before, abs=2e-3)


@pytest.mark.parametrize("way", ["button", "key", "key in the view"])
def test_stop_stops_and_is_released_in_two_steps(page, viser_page, idle, way):
    idle.switch_controllers(start=[CONTROLLER])
    if way == "button":
        page.get_by_role("button", name="STOP", exact=True).click()
    elif way == "key":
        page.keyboard.press("Escape")
    else:
        viser_page.open_tab("Joints")
        page.keyboard.press(" ")
    assert wait_until(lambda: idle.status().stop_state == "stopped")
    for name in ("Release stop", "Allow motion"):
        page.get_by_role("button", name=name).dispatch_event("click")
    assert wait_until(lambda: idle.status().stop_state == "armed")
    assert _state(idle, CONTROLLER) != "running"


def test_an_arm_that_stopped_itself_is_recovered_by_clicking(page, idle):
    trouble = page.locator("#trouble")
    panda = idle.robot("panda")
    panda.inject(Fault(kind="collision", cycles=30))
    trouble.get_by_text("panda stopped itself: ").wait_for()
    keep_screenshot(page, "dashboard_reflex.png")
    trouble.get_by_role("button", name="Recover panda").click()
    assert wait_until(lambda: panda.errors().robot_mode == "idle")
    trouble.wait_for(state="hidden")
    panda.user_stop(pressed=True)
    trouble.get_by_role("button", name="Release the user stop of panda").click()
    assert wait_until(lambda: panda.errors().robot_mode == "idle")


def test_typing_a_space_does_not_stop(page, viser_page, idle):
    idle.switch_controllers(start=[CONTROLLER])
    viser_page.open_tab("Gains")
    viser_page.frame.get_by_text("p [Nm/rad]").wait_for()
    viser_page.box("p [Nm/rad]").click()
    page.keyboard.type("6 1")
    assert idle.status().stop_state == "armed"
