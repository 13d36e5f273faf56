"""The workspace in a real browser, at a real station: docks, strip, first minute."""

import re
from pathlib import Path

import pytest

from station.api.errors import ROUTES
from station.wire import Fault
from tests.browser.conftest import keep_screenshot
from tests.browser.workspace_page import (
    CONTROLLER,
    OTHER,
    WorkspacePage,
    position,
    wait_until,
    without_scene,
)

pytestmark = pytest.mark.slow


def _state(client, name):
    return client.controller(name).state


def test_a_newcomer_is_shown_around_and_enables_the_sliders(workspace, client):
    page = workspace.page
    tour = page.locator("#tour")
    for step in (1, 2, 3):
        tour.get_by_text(f"{step} of 4").wait_for()
        tour.get_by_role("button", name="Next").click()
    tour.get_by_role("button", name="Done").click()
    assert not tour.is_visible()
    page.get_by_role("button", name="Enable sliders").click()
    assert wait_until(lambda: _state(client, CONTROLLER) == "running")
    page.locator("#enable").wait_for(state="hidden")


def test_a_typed_value_keeps_its_precision(workspace, enabled):
    workspace.button("joints", "rad").click()
    workspace.type_into("joints", "Command of joint1", "0.3217")
    sent = 0.3217
    assert wait_until(
        lambda: (enabled.last_command(CONTROLLER).last or [None])[0] == sent
    )
    assert wait_until(lambda: abs(position(enabled, "panda_joint1") - sent) < 0.02)
    field = workspace.dock("joints").get_by_label("Command of joint1", exact=True)
    assert field.input_value() == "0.3217"


def test_degrees_are_converted_exactly(workspace, enabled):
    workspace.button("joints", "deg").click()
    workspace.type_into("joints", "Command of joint3", "10")
    wanted = 0.17453292519943295
    assert wait_until(
        lambda: enabled.last_command(CONTROLLER).last[2] == pytest.approx(wanted)
    )


def test_a_value_beyond_the_limit_is_refused_with_the_range(workspace, enabled):
    before = enabled.last_command(CONTROLLER).last
    workspace.type_into("joints", "Command of joint2", "400")
    line = workspace.page.locator("#refusal-line")
    line.get_by_text(re.compile(r"allowed are -101(\.\d+)? to 101(\.\d+)?")).wait_for()
    assert enabled.last_command(CONTROLLER).last == before


def test_a_joint_moves_while_its_button_is_held_and_stays_after(workspace, enabled):
    page, before = workspace.page, position(enabled, "panda_joint7")
    workspace.button("joints", "Move joint7 down while held").hover()
    page.mouse.down()
    assert wait_until(lambda: position(enabled, "panda_joint7") < before - 0.1)
    page.mouse.up()
    page.wait_for_timeout(500)
    assert position(enabled, "panda_joint7") > before - 1.0
    rest = enabled.last_command(CONTROLLER).last[6]
    workspace.page.wait_for_timeout(300)
    assert enabled.last_command(CONTROLLER).last[6] == rest


def test_stop_is_shown_at_once_and_refused_values_offer_the_release(workspace, enabled):
    page = workspace.page
    page.locator("#stop").click()
    page.locator("#motion").get_by_text("STOPPED").wait_for(timeout=2000)
    assert enabled.status().stop_state == "stopped"
    start = workspace.button("controllers", f"Start {CONTROLLER}")
    assert wait_until(start.is_disabled)
    # As by a page that has not heard of the stop yet.
    switch = "async (name) => (await import('/static/lib/store.js')).switchTo(name)"
    page.evaluate(switch, CONTROLLER)
    remedy = page.locator("#refusal-line").get_by_role("button", name="Release stop")
    remedy.click()
    assert wait_until(lambda: enabled.status().stop_state == "released")
    page.locator("#bar").get_by_role("button", name="Allow motion").click()
    assert wait_until(lambda: enabled.status().stop_state == "armed")
    page.locator("#log-button").click()
    assert page.locator("#log .row").count() >= 1
    assert "/api/v1" not in page.locator("#log").inner_text()
    page.locator("#log-button").click()


@pytest.mark.parametrize(
    ("for_scripts", "for_people"),
    [
        *((sentence, "") for sentence in ROUTES.values()),
        ("Stop it first. GET /api/v1/loop has more.", "Stop it first."),
        ("Take control first: POST /api/v1/control.", "Take control first."),
        ("Move it by hand (POST /robots/panda/error_recovery)", "Move it by hand"),
        ("Stay within 0.5 rad. Ask again.", "Stay within 0.5 rad. Ask again."),
    ],
)
def test_a_person_is_not_told_routes(workspace, for_scripts, for_people):
    told = workspace.page.evaluate(
        "async (text) => (await import('/static/lib/refusals.js')).forPerson(text)",
        for_scripts,
    )
    assert told == for_people


def test_a_switch_says_what_it_does_before_the_click(workspace, enabled):
    start = workspace.button("controllers", f"Start {OTHER}")
    start.hover()
    preview = workspace.dock("controllers").locator(".preview")
    preview.get_by_text(f"stops {CONTROLLER}").wait_for()
    assert _state(enabled, OTHER) != "running"
    start.click()
    assert wait_until(lambda: _state(enabled, OTHER) == "running")
    assert _state(enabled, CONTROLLER) != "running"
    # How far each joint stepped is known now; a start from rest steps none by much.
    preview.get_by_text(f"Started {OTHER}: ").wait_for()


def test_a_controller_is_loaded_from_a_form_and_unloaded(workspace, client):
    dock = workspace.dock("controllers")
    workspace.button("controllers", "Load …").click()
    kind = "velocity_controllers/JointGroupVelocityController"
    dock.get_by_label("Search controller types").fill("group velocity")
    dock.get_by_role("option", name=kind).click()
    dock.get_by_label("Name of the controller").fill("mine")
    dock.get_by_role("button", name="Load", exact=True).click()
    assert wait_until(lambda: "mine" in [c.name for c in client.controllers()])
    workspace.button("controllers", "Unload mine").click()
    assert wait_until(lambda: "mine" not in [c.name for c in client.controllers()])


def test_gains_change_together_and_are_undone(workspace, enabled):
    dock = workspace.dock("tuning")
    dock.get_by_label("Controller to tune").select_option(CONTROLLER)
    dock.get_by_label("Joint to tune").select_option("panda_joint6")
    dock.get_by_label("p of panda_joint6").fill("140.5")
    dock.get_by_label("d of panda_joint6").fill("9.25")
    before = enabled.gains(CONTROLLER)
    workspace.button("tuning", "Apply").click()
    assert wait_until(
        lambda: enabled.gains(CONTROLLER).values["panda_joint6/p"] == 140.5
    )
    after = enabled.gains(CONTROLLER)
    assert after.values["panda_joint6/d"] == 9.25
    assert after.revision == before.revision + 1
    workspace.button("tuning", "Undo").click()
    assert wait_until(lambda: enabled.gains(CONTROLLER).values == before.values)


def test_two_tests_of_a_joint_are_compared(workspace, enabled):
    dock = workspace.dock("tuning")
    dock.get_by_label("Controller to tune").select_option(CONTROLLER)
    dock.get_by_label("Joint to tune").select_option("panda_joint5")
    dock.get_by_label("for [s]").fill("0.8")
    before = position(enabled, "panda_joint5")
    run = workspace.button("tuning", "Run test")
    run.click()
    dock.locator(".metrics tbody tr").nth(0).get_by_text("ms").first.wait_for()
    run.click()
    dock.locator(".metrics tbody tr").nth(1).wait_for()
    dock.get_by_label("Kind of test").select_option("chirp")
    run.click()
    rows = dock.locator(".metrics tbody tr")
    rows.filter(has_text="chirp").first.wait_for()
    assert wait_until(lambda: abs(position(enabled, "panda_joint5") - before) < 0.02)


def test_waypoints_are_captured_and_played(workspace, enabled):
    here = position(enabled, "panda_joint1")
    workspace.button("move", "+ Capture").click()
    workspace.button("joints", "rad").click()
    workspace.type_into("joints", "Command of joint1", f"{here + 0.2:.3f}")
    assert wait_until(lambda: position(enabled, "panda_joint1") > here + 0.15)
    workspace.button("move", "▶ Play").click()
    dock = workspace.dock("move")
    dock.get_by_text("The motion succeeded.").wait_for(timeout=8000)
    assert position(enabled, "panda_joint1") == pytest.approx(here, abs=0.02)
    dock.get_by_role("button", name="Remove: point 1").click()


def test_the_gripper_opens_and_closes(workspace, client):
    panda = client.robot("panda")
    workspace.button("gripper", "Close").click()
    assert wait_until(lambda: panda.gripper.state().width < 0.01)
    workspace.button("gripper", "Open").click()
    assert wait_until(lambda: panda.gripper.state().width > 0.07)


def test_an_arm_that_stopped_itself_is_recovered_by_one_click(workspace, client):
    panda = client.robot("panda")
    panda.inject(Fault(kind="collision", cycles=30))
    line = workspace.page.locator("#trouble")
    line.get_by_text("panda stopped itself").wait_for()
    line.get_by_role("button", name="Recover panda").click()
    assert wait_until(lambda: panda.errors().robot_mode == "idle")
    line.wait_for(state="hidden")


def test_the_simulation_pauses_and_steps(workspace, client):
    workspace.button("simulation", "Pause").click()
    assert wait_until(lambda: client.simulation.state().paused)
    time_before = client.simulation.state().time
    workspace.button("simulation", "Step").click()
    assert wait_until(lambda: client.simulation.state().time > time_before + 0.09)
    workspace.button("simulation", "Resume").click()
    assert wait_until(lambda: not client.simulation.state().paused)


def test_a_plot_takes_other_channels(workspace):
    dock = workspace.dock("plots").locator(".plot").first
    dock.locator(".picker > summary").first.click()
    dock.get_by_role("button", name="hand z [m]").first.click()
    assert "hand z" in dock.locator(".legend").first.inner_text()
    dock.locator(".picker > summary").first.click()


def test_events_come_as_they_happen(workspace, client):
    workspace.button("timeline", "Events").click()
    log = workspace.dock("timeline").locator(".log")
    client.stop("a test of the timeline")
    log.get_by_text("a test of the timeline").first.wait_for(timeout=3000)
    client.release_stop()
    client.release_stop(arm=True)


def test_a_recording_is_started_stopped_and_downloaded(workspace, client):
    page = workspace.page
    workspace.button("timeline", "Recordings").click()
    workspace.button("timeline", "Record").click()
    stop = workspace.button("timeline", "Stop recording")
    stop.wait_for()
    running = client.recordings.list()[-1]
    assert running.state == "recording"
    stop.click()
    row = workspace.dock("timeline").locator(".log .row").first
    row.get_by_text("stopped").wait_for()
    assert client.recordings.get(running.identifier).state == "stopped"
    with page.expect_download() as download:
        row.get_by_role("link", name="download").click()
    kept = Path(download.value.path()).read_bytes()
    assert kept.startswith(b"\x89MCAP")
    assert len(kept) == client.recordings.get(running.identifier).size


def test_a_stop_is_kept_as_an_incident(workspace, client):
    why = "a stop that is kept"
    client.stop(why)
    client.release_stop()
    client.release_stop(arm=True)
    workspace.button("timeline", "Incidents").click()
    row = workspace.dock("timeline").locator(".log .row").filter(has_text=why)
    row.get_by_role("link", name="download").wait_for()
    assert why in " ".join(client.incidents.list()[-1].causes)


def test_no_token_reaches_the_page(workspace, running_station):
    page = workspace.page
    stored = page.evaluate("() => JSON.stringify([localStorage, document.cookie])")
    assert running_station.token not in stored
    assert running_station.token not in page.content()


def test_the_layout_is_kept_in_this_browser(workspace):
    page = workspace.page
    width = page.locator("#side").bounding_box()["width"]
    handle = page.locator("#split-side")
    handle.focus()
    for _ in range(3):
        page.keyboard.press("ArrowLeft")
    workspace.button("gripper", "Gripper").click()
    page.reload()
    WorkspacePage(page)
    assert page.locator("#side").bounding_box()["width"] == pytest.approx(width + 48)
    gripper = page.locator('.dock[data-dock="gripper"] .fold')
    assert gripper.get_attribute("aria-expanded") == "false"
    gripper.click()


@pytest.mark.parametrize("size", [(1280, 800), (1920, 1080), (390, 844)])
def test_nothing_is_cut_off(workspace, size):
    page = workspace.page
    page.set_viewport_size({"width": size[0], "height": size[1]})
    page.wait_for_function("(width) => innerWidth === width", arg=size[0])
    page.evaluate("() => new Promise((done) => requestAnimationFrame(done))")
    keep_screenshot(page, f"workspace_{size[0]}x{size[1]}.png")
    wide = page.evaluate("() => document.documentElement.scrollWidth - innerWidth")
    stop = page.locator("#stop").bounding_box()
    cut = page.locator(".dock .scroll").evaluate_all(
        "all => all.filter((one) => one.checkVisibility() &&"
        " one.scrollWidth > one.clientWidth).map((one) => one.innerText.slice(0, 60))"
    )
    page.set_viewport_size({"width": 1280, "height": 800})
    assert wide <= 0
    assert cut == []
    assert stop["x"] >= 0
    assert stop["x"] + stop["width"] <= size[0]
    assert stop["y"] + stop["height"] <= size[1]


def test_a_viewer_watches_and_stops_and_changes_nothing(
    browser, running_station, client
):
    context = browser.new_context(viewport={"width": 1280, "height": 800})
    without_scene(context)
    page = context.new_page()
    page.goto(f"{running_station.ui}/login?token={running_station.viewer_token}")
    workspace = WorkspacePage(page)
    workspace.page.get_by_text("Viewer: watching only").wait_for()
    assert workspace.button("controllers", f"Start {OTHER}").is_disabled()
    status = page.evaluate(
        "async () => (await fetch('/api/v1/controllers/switch', {method: 'POST', "
        "headers: {'Content-Type': 'application/json'}, body: '{}'})).status"
    )
    assert status == 403
    page.locator("#stop").click()
    assert wait_until(lambda: client.status().stop_state == "stopped")
    context.close()
    client.release_stop()
    client.release_stop(arm=True)
