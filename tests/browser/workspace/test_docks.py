"""Docks of the workspace at a real station: paths, load form, plots, replay, search."""

import pytest

from station.wire import Fault
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


def test_a_path_is_kept_by_the_station_and_played_in_a_loop(workspace, enabled):
    page = workspace.page
    for _ in range(2):
        workspace.button("move", "+ Capture").click()
        here = position(enabled, "panda_joint1")
        workspace.button("joints", "rad").click()
        workspace.type_into("joints", "Command of joint1", f"{here + 0.15:.3f}")
        assert wait_until(lambda h=here: position(enabled, "panda_joint1") > h + 0.1)
    with page.expect_response("**/ui/ghost") as ghost:
        workspace.button("move", "Preview").click()
    assert ghost.value.json() == {"shown": True}
    workspace.button("move", "Preview").click()
    page.reload()
    workspace = WorkspacePage(page)
    rows = workspace.dock("move").locator("ol.waypoints li")
    rows.nth(1).wait_for()
    assert enabled.waypoint_paths.names() == ["path-1"]
    workspace.button("move", "Loop").click()
    workspace.button("move", "▶ Play").click()
    paths = enabled.waypoint_paths
    assert wait_until(lambda: (p := paths.playback()) and p.state == "playing")
    workspace.button("move", "Pause").click()
    assert wait_until(lambda: paths.playback().state == "paused")
    workspace.button("move", "Resume").click()
    assert wait_until(lambda: paths.playback().state == "playing")
    assert paths.playback().loop
    workspace.button("move", "Cancel").click()
    assert wait_until(lambda: paths.playback().state == "cancelled")
    workspace.button("move", "Loop").click()
    workspace.button("move", "Delete").click()
    assert wait_until(lambda: paths.names() == [])


def test_the_load_form_has_what_the_type_declares(workspace, client):
    kind = "velocity_controllers/JointGroupVelocityController"
    known = next(t for t in client.controller_types() if t.type == kind)
    assert known.parameters
    dock = workspace.dock("controllers")
    workspace.button("controllers", "Load …").click()
    dock.get_by_label("Search controller types").fill("group velocity")
    dock.get_by_role("option", name=kind).click()
    plain = [p for p in known.parameters if "<" not in p.name and p.type != "mappings"]
    for parameter in plain:
        label = parameter.name.replace("/", " / ")
        field = dock.get_by_label(label, exact=True)
        field.wait_for()
        if parameter.default is not None and not field.input_value():
            shown = field.get_attribute("placeholder") or field.inner_text()
            assert "default" in shown
    dock.get_by_label("Name of the controller").fill("declared")
    dock.get_by_role("button", name="Load", exact=True).click()
    assert wait_until(lambda: "declared" in [c.name for c in client.controllers()])
    client.unload_controller("declared")


def test_a_plot_draws_rates_and_one_channel_over_another(workspace):
    dock = workspace.dock("plots")
    box = dock.locator(".plot").first
    box.locator(".picker > summary").click()
    box.get_by_role("button", name="rate of change of q joint1", exact=True).click()
    box.get_by_role("button", name="XY", exact=True).click()
    box.locator(".picker > summary").click()
    assert "d/dt q joint1" in box.locator(".chart").get_attribute("aria-label")
    kept = workspace.page.evaluate("() => localStorage.getItem('station.plots-2')")
    assert '"xy":true' in kept
    assert "d/dt position/panda_joint1" in kept
    box.locator(".picker > summary").click()
    box.get_by_role("button", name="XY", exact=True).click()
    box.get_by_role("button", name="rate of change of q joint1", exact=True).click()
    box.locator(".picker > summary").click()


def test_every_number_of_a_stream_can_be_plotted_and_is_kept(workspace):
    box = workspace.dock("plots").locator(".plot").first
    box.locator(".picker > summary").click()
    box.get_by_label("Search channels").fill("loop total p99")
    choice = box.get_by_role("button", name="loop loop total p99 [s]", exact=True)
    choice.click()
    kept = "() => localStorage.getItem('station.plots-2')"
    assert "loop|loop/total/p99" in workspace.page.evaluate(kept)
    workspace.page.wait_for_function(
        "() => document.querySelector('st-plots').history('loop|loop/total/p99')"
        ".values.at(-1) > 0"
    )
    box.get_by_label("Search channels").fill("gripper width")
    box.get_by_role("button", name="gripper/panda width [m]", exact=True).wait_for()
    box.get_by_label("Search channels").fill("panda tau_J_d [6]")
    box.get_by_role("button", name="panda tau_J_d [6] [Nm]", exact=True).wait_for()
    box.get_by_label("Search channels").fill("loop total p99")
    choice.click()
    box.locator(".picker > summary").click()


def test_the_strip_stays_one_line_when_an_arm_has_stopped_itself(workspace, client):
    page, panda = workspace.page, client.robot("panda")
    bar = page.locator("#bar")
    height = bar.bounding_box()["height"]
    panda.inject(Fault(kind="collision", cycles=30))
    page.locator("#mode").get_by_text("reflex").wait_for()
    page.locator("#alarms").wait_for()
    assert bar.bounding_box()["height"] == height
    page.get_by_role("button", name="Recover panda").click()
    assert wait_until(lambda: panda.errors().robot_mode == "idle")


@pytest.mark.parametrize(("width", "rows"), [(1280, [2, 2, 1]), (2560, [3, 2])])
def test_the_choices_of_the_timeline_stand_in_even_rows(workspace, width, rows):
    page = workspace.page
    workspace.dock("simulation")
    page.set_viewport_size({"width": width, "height": 900})
    page.wait_for_function("(width) => innerWidth === width", arg=width)
    tabs = workspace.dock("timeline").locator(".tabs")
    tops = tabs.locator("button:visible").evaluate_all(
        "(all) => all.map((one) => one.getBoundingClientRect().top)"
    )
    is_cut = tabs.evaluate("(one) => one.scrollWidth > one.clientWidth")
    page.set_viewport_size({"width": 1280, "height": 800})
    assert [tops.count(top) for top in sorted(set(tops))] == rows
    assert not is_cut


def _answers_ghost(method):
    """Return whether a response is that of a request about the ghost."""
    return lambda r: r.url.endswith("/ui/ghost") and r.request.method == method


def test_a_replay_shows_a_ghost_and_moves_nothing(workspace, enabled):
    page = workspace.page
    recording = enabled.recordings.start()
    assert let_pass(enabled, 0.5)
    enabled.recordings.stop(recording.identifier)
    workspace.button("timeline", "Recordings").click()
    name = f"Replay {recording.identifier}"
    sent = []
    page.on("request", lambda request: sent.append((request.method, request.url)))
    workspace.dock("timeline").get_by_role("button", name=name, exact=True).click()
    slider = workspace.dock("plots").get_by_label("Time of the replay")
    slider.wait_for()
    before = enabled.last_command(CONTROLLER).last
    with page.expect_response(_answers_ghost("POST")) as shown:
        slider.press("End")
    assert shown.value.ok
    with page.expect_response(_answers_ghost("DELETE")) as hidden:
        workspace.button("plots", "End replay").click()
    assert hidden.value.ok
    assert enabled.last_command(CONTROLLER).last == before
    assert not [u for m, u in sent if m != "GET" and "/api/v1/" in u]


def test_an_incident_is_replayed_as_a_ghost(workspace, enabled):
    known = {one.identifier for one in enabled.incidents.list()}
    enabled.stop("a test")

    def new():
        found = enabled.incidents.list()
        return [one.identifier for one in found if one.identifier not in known]

    assert wait_until(new, 20.0)
    (incident,) = new()
    enabled.release_stop()
    enabled.release_stop(arm=True)
    workspace.button("timeline", "Incidents").click()
    dock = workspace.dock("timeline")
    replay = dock.get_by_role("button", name=f"Replay {incident}", exact=True)
    with workspace.page.expect_response(_answers_ghost("POST")) as shown:
        replay.click()
    assert shown.value.json() == {"shown": True}
    asked = shown.value.request.post_data_json
    assert len(asked["positions"]) >= 7
    with workspace.page.expect_response(_answers_ghost("DELETE")):
        workspace.button("plots", "End replay").click()
    workspace.button("timeline", "Events").click()


def test_on_a_narrow_screen_the_first_tap_shows_what_is_in_a_dock(
    browser, running_station
):
    with logged_in(browser, running_station, width=390, begin=without_scene) as page:
        page.wait_for_selector('#bar[data-link="live"]')
        shown = {
            "Waypoints and moves": ("move", "+ Capture"),
            "Tuning": ("tuning", "Run test"),
            "Simulation": ("simulation", "Reset"),
        }
        for title, (dock, button) in shown.items():
            page.locator("#docks-nav").get_by_role("button", name=title).click()
            place = page.locator(f'.dock[data-dock="{dock}"]')
            place.get_by_role("button", name=button, exact=True).wait_for()


def test_only_the_newest_preview_of_a_switch_is_shown(workspace, enabled):
    names = [c.name for c in enabled.controllers() if c.state != "running"][:2]
    preview = workspace.dock("controllers").locator(".preview")
    held = []

    def hold_the_first(route):
        (route.continue_ if held else held.append)(*([] if held else [route]))

    workspace.page.route("**/controllers/switch", hold_the_first)
    first, second = (workspace.button("controllers", f"Start {n}") for n in names)
    first.focus()
    assert wait_until(lambda: workspace.page.wait_for_timeout(50) or held)
    second.focus()
    preview.get_by_text(f"Start {names[1]}: ").wait_for()
    with workspace.page.expect_response("**/controllers/switch"):
        held[0].continue_()
    workspace.page.wait_for_timeout(100)
    assert preview.inner_text().startswith(f"Start {names[1]}: ")
    workspace.page.unroute("**/controllers/switch")


@pytest.mark.usefixtures("enabled")
def test_nothing_is_tuned_without_gains(workspace):
    dock = workspace.dock("tuning")
    chosen = dock.get_by_label("Controller to tune")
    chosen.select_option("position_group_controller")
    dock.get_by_text("no gains that can be changed").wait_for()
    assert dock.get_by_role("button", name="Apply", exact=True).is_disabled()
    assert dock.get_by_role("button", name="Tune for me").is_hidden()
    chosen.select_option(CONTROLLER)
    dock.get_by_role("button", name="Tune for me").wait_for()
    gain = dock.locator(".gains input").first
    apply = dock.get_by_role("button", name="Apply", exact=True)
    assert apply.is_disabled()  # nothing was typed
    was = gain.input_value()
    gain.fill("1")
    assert apply.is_enabled()
    gain.fill(was)
    assert apply.is_disabled()


def test_gains_are_searched_previewed_applied_and_taken_back(workspace, enabled):
    dock = workspace.dock("tuning")
    before = enabled.gains(CONTROLLER).values
    dock.get_by_label("Number of trials of the search").fill("4")
    dock.get_by_label("for of the search [s]").fill("0.3")
    dock.get_by_role("button", name="Tune for me").click()
    preview = dock.get_by_role("button", name="Preview gains")
    preview.wait_for(timeout=120_000)
    search = dock.locator("st-tune-search")
    search.get_by_text(": done").wait_for(timeout=120_000)
    assert enabled.gains(CONTROLLER).values == before
    # The best of so few trials may be the first: other gains make sure of a difference.
    name = "panda_joint1/p"
    other = {name: 0.9 * before[name]}
    enabled.set_gains(CONTROLLER, other)
    preview.click()
    search.get_by_text("Would change").wait_for()
    assert enabled.gains(CONTROLLER).values[name] == other[name]
    search.get_by_role("button", name="Apply these").click()
    assert wait_until(lambda: enabled.gains(CONTROLLER).values[name] != other[name])
    workspace.button("tuning", "Undo").click()
    assert wait_until(lambda: enabled.gains(CONTROLLER).values[name] == other[name])
    enabled.set_gains(CONTROLLER, before)
    _opens_the_trials_in_the_plots(workspace, enabled)


def _opens_the_trials_in_the_plots(workspace, client):
    """The best trial is laid over the one at which the search began."""
    (search,) = client.experiments.list()
    workspace.button("timeline", "Experiments").click()
    workspace.button("timeline", f"Replay {search.name}").click()
    kept = {one.role: one for one in client.experiments.responses(search.name)}
    # The best of so few trials may be the first.
    wanted = [kept[role] for role in ("best", "first") if role in kept]
    shown = workspace.dock("plots")
    shown.get_by_text(f"{search.name}, {wanted[-1].role}", exact=True).wait_for()
    traces = "document.querySelector('st-plots').plots[0].plot.traces"
    count = 7 * len(wanted)
    found = workspace.page.wait_for_function(
        f"() => {traces}.length === {count} &&"
        f" {traces}.map((t) => t.history.values.at(-1))"
    ).json_value()
    assert found == pytest.approx([q for one in wanted for q in one.position[-1]])
    workspace.button("plots", "End replay").click()
    workspace.button("timeline", "Events").click()


def test_a_controller_keeps_its_row_when_it_is_started(workspace, enabled):
    page, dock = workspace.page, workspace.dock("controllers")
    rows = dock.locator("tbody th[scope=row]")
    before = rows.all_inner_texts()
    start = workspace.button("controllers", f"Start {OTHER}")
    start.hover()
    page.mouse.down()
    page.mouse.up()  # and the pointer stays where it is
    preview = dock.locator(".preview")
    preview.get_by_text(f"Started {OTHER}").wait_for()
    assert enabled.controller(OTHER).state == "running"
    assert rows.all_inner_texts() == before
    # What the table was drawn anew for has come by then; nothing took the line's place.
    page.wait_for_timeout(1500)
    assert preview.inner_text().startswith(f"Started {OTHER}")
    enabled.switch_controllers(start=[CONTROLLER], stop=[OTHER])
    workspace.button("controllers", f"Stop {CONTROLLER}").wait_for()
    assert rows.all_inner_texts() == before
    assert preview.inner_text().startswith(f"Started {OTHER}")
