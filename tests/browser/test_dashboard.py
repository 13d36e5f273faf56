"""The dashboard in a real browser, at a real station."""

import time

import pytest

from station.wire import Fault
from tests.browser.conftest import keep_screenshot
from tests.browser.viser_page import ViserPage

pytestmark = pytest.mark.slow

CONTROLLER = "effort_group_position_controller"


TRIANGLES = "() => window.__viserTestpoints.rendererInfo.render.triangles"


def _position(client, joint):
    joints = client.joint_states()
    return joints.position[joints.name.index(joint)]


def _wait_until(holds, seconds=15.0):
    """Poll `holds` until it is true; whoever calls asserts the outcome."""
    deadline = time.monotonic() + seconds
    while not holds() and time.monotonic() < deadline:
        time.sleep(0.05)
    return holds()


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
    running = [c.name for c in client.controllers() if c.state == "running"]
    moving = [name for name in running if name != "joint_state_controller"]
    if moving:
        client.switch_controllers(stop=moving)


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
    pulled = _wait_until(lambda: pushes() and "200" in pushes()[0])
    keep_screenshot(page, "dashboard_pull.png")
    page.mouse.up()
    assert pulled
    panda = idle.robot("panda")
    assert _wait_until(lambda: max(map(abs, panda.state().O_F_ext_hat_K)) < 10.0)
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


def test_a_controller_is_started_by_clicking_and_a_slider_moves_the_joint(
    page, viser_page, idle
):
    before = _position(idle, "panda_joint1")
    viser_page.open_tab("Controllers")
    viser_page.select("Controller", CONTROLLER)
    viser_page.click("Start")
    assert _wait_until(lambda: _state(idle, CONTROLLER) == "running")
    viser_page.open_tab("Operate")
    viser_page.frame.get_by_text(f"Sliders command {CONTROLLER}").wait_for()
    assert _position(idle, "panda_joint1") == pytest.approx(before, abs=2e-3)
    viser_page.drag_slider("joint1 [rad]", 0.62)
    assert _wait_until(lambda: _position(idle, "panda_joint1") > before + 0.4)
    keep_screenshot(page, "dashboard_operate.png")
    viser_page.open_tab("Tune")
    viser_page.frame.get_by_text("p [Nm/rad]").wait_for()
    command = idle.controller_state(CONTROLLER).desired
    told = command[0] + 0.1
    idle.command(CONTROLLER, [told, *command[1:]])
    assert _wait_until(lambda: abs(_position(idle, "panda_joint1") - told) < 0.01)
    keep_screenshot(page, "dashboard_tune.png")


def test_a_gain_slider_changes_the_gain(viser_page, idle):
    idle.switch_controllers(start=[CONTROLLER])
    name = "panda_joint1/p"
    before = idle.gains(CONTROLLER).values[name]
    viser_page.open_tab("Tune")
    viser_page.frame.get_by_text("p [Nm/rad]").wait_for()
    viser_page.drag_slider("p [Nm/rad]", 0.15)
    assert _wait_until(lambda: idle.gains(CONTROLLER).values[name] < before)
    idle.set_gains(CONTROLLER, {name: before})


@pytest.mark.usefixtures("idle")
def test_greyed_sliders_say_why(viser_page):
    viser_page.open_tab("Operate")
    viser_page.frame.get_by_text("nothing that runs takes set-points").wait_for()
    viser_page.row("joint1 [rad]").locator("[data-disabled]").first.wait_for()


def test_a_refusal_is_shown_as_the_station_words_it(page, viser_page, idle):
    viser_page.open_tab("Controllers")
    viser_page.fill("Name", "broken")
    viser_page.fill("Parameters", "joints: [no_such_joint]")
    viser_page.click("Load")
    viser_page.frame.get_by_role("alert").get_by_text("no_such_joint").wait_for()
    page.locator("#notice").get_by_text("no_such_joint").wait_for()
    assert "broken" not in [c.name for c in idle.controllers()]


def test_controllers_started_elsewhere_appear(viser_page, idle):
    viser_page.open_tab("Controllers")
    table = viser_page.frame.get_by_role("table", name="Loaded controllers")
    row = table.get_by_role("row").filter(has_text="position_group_controller").last
    idle.switch_controllers(start=["position_group_controller"])
    row.get_by_text("running").wait_for(timeout=5000)


@pytest.mark.parametrize("way", ["button", "key", "key in the view"])
def test_stop_stops_and_is_released_in_two_steps(page, viser_page, idle, way):
    idle.switch_controllers(start=[CONTROLLER])
    if way == "button":
        page.get_by_role("button", name="STOP", exact=True).click()
    elif way == "key":
        page.keyboard.press("Escape")
    else:
        viser_page.open_tab("Controllers")
        page.keyboard.press(" ")
    assert _wait_until(lambda: idle.status().stop_state == "stopped")
    page.get_by_role("button", name="Release stop").click()
    page.get_by_role("button", name="Allow motion").click()
    assert _wait_until(lambda: idle.status().stop_state == "armed")
    assert _state(idle, CONTROLLER) != "running"


def test_an_arm_that_stopped_itself_is_recovered_by_clicking(page, viser_page, idle):
    recover = viser_page.frame.get_by_role("button", name="Recover panda", exact=True)
    assert recover.count() == 0
    panda = idle.robot("panda")
    panda.inject(Fault(kind="collision", cycles=30))
    viser_page.frame.get_by_text("panda stopped itself: ").wait_for()
    keep_screenshot(page, "dashboard_reflex.png")
    viser_page.click("Recover panda")
    assert _wait_until(lambda: panda.errors().robot_mode == "idle")
    recover.wait_for(state="detached")
    panda.user_stop(pressed=True)
    viser_page.click("Release the user stop of panda")
    assert _wait_until(lambda: panda.errors().robot_mode == "idle")


def test_typing_a_space_does_not_stop(page, viser_page, idle):
    viser_page.open_tab("Controllers")
    viser_page.box("Name").click()
    page.keyboard.type("a b")
    assert idle.status().stop_state == "armed"
