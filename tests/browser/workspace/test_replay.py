"""Recordings in the plots: their numbers, comparison, notes, and links for others."""

import csv
import json
import math
import re
from pathlib import Path

import pytest

from tests.browser.conftest import logged_in
from tests.browser.test_tasks import counted
from tests.browser.workspace_page import (
    CONTROLLER,
    WorkspacePage,
    let_pass,
    wait_until,
    without_scene,
)

pytestmark = pytest.mark.long

PLOTS = "document.querySelector('st-plots').plots"


def _record(client, name, pose):
    """Record how joint 1 goes to a pose; return the recording."""
    recording = client.recordings.start(name)
    client.command(CONTROLLER, [pose, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785])
    assert let_pass(client, 1.5)
    return client.recordings.stop(recording.identifier)


@pytest.fixture
def compared(workspace, enabled):
    """Two recordings of joint 1, to 0.2 rad and back, over each other in the plots."""
    known = {one.name: one for one in enabled.recordings.list()}
    tuesday = known.get("tuesday") or _record(enabled, "tuesday", 0.2)
    mine = known.get("mine") or _record(enabled, "mine", 0.0)
    clicked = (
        "Recordings",
        f"Replay {tuesday.identifier}",
        f"Compare with {mine.identifier}",
    )
    task = "compare my run with last Tuesday's recording"
    assert len(clicked) == counted(task) <= 6
    workspace.dock("timeline")
    for name in clicked:
        workspace.page.get_by_role("button", name=name, exact=True).first.click()
    box = workspace.dock("plots").locator(".plot").first
    box.get_by_text("1 B").wait_for()
    yield tuesday, mine
    workspace.button("plots", "End replay").click()
    assert workspace.page.evaluate(f"() => {PLOTS}[0].plot.end") is None
    rows = workspace.dock("timeline")
    compare = rows.get_by_role("button", name=re.compile("^Compare"))
    # Drawn once the station has answered.
    assert wait_until(lambda: compare.count() == 0)


def _rows(client, recording, tmp_path):
    """Return the time since the begin, and joint 1, of every cycle of a recording."""
    path = client.recordings.download_table(
        recording.identifier,
        tmp_path / f"{recording.name}.csv",
        channels=["joint_states/position/panda_joint1"],
    )
    with path.open() as file:
        rows = list(csv.DictReader(file))
    first = float(rows[0]["time"])
    column = "joint_states/position/panda_joint1"
    return [(float(row["time"]) - first, float(row[column])) for row in rows]


def _area(workspace):
    """Return the part of the first plot in which its traces are."""
    plot = workspace.dock("plots").locator(".plot").first
    return plot.locator(".u-over").bounding_box()


def test_the_legend_has_the_numbers_of_both_recordings_at_the_cursor(
    workspace, client, compared, tmp_path
):
    page, area = workspace.page, _area(workspace)
    box = workspace.dock("plots").locator(".plot").first
    page.mouse.move(area["x"] + 0.6 * area["width"], area["y"] + 30)
    box.locator(".legend b").get_by_text(" at ").wait_for()
    cursor = page.evaluate(f"() => {PLOTS}[0].plot.cursor")
    shown = box.locator(".trace output").all_inner_texts()
    assert len(shown) == 14
    for text, recording in zip((shown[0], shown[7]), compared, strict=True):
        rows = _rows(client, recording, tmp_path)
        _, wanted = min(rows, key=lambda row: abs(row[0] - cursor))
        value = float(re.match(r"-?[\d.]+", text)[0])
        assert value == pytest.approx(math.degrees(wanted), abs=6e-5)


def test_a_click_goes_to_a_time_and_a_note_on_what_is_shown_stays_in_the_file(
    workspace, client, compared
):
    page, area, (tuesday, _) = workspace.page, _area(workspace), compared
    y = area["y"] + 30
    with page.expect_response(lambda r: r.url.endswith("/ui/ghost")) as told:
        page.mouse.click(area["x"] + 0.5 * area["width"], y)
    assert told.value.ok
    moment = page.evaluate(f"() => {PLOTS}.map(({{plot}}) => plot.fixed)")
    assert moment[0] == moment[1] == pytest.approx(tuesday.duration / 2, rel=0.05)
    page.mouse.move(area["x"] + 0.25 * area["width"], y)
    page.mouse.down()
    page.mouse.move(area["x"] + 0.75 * area["width"], y, steps=4)
    page.mouse.up()
    workspace.button("plots", "Note").click()
    page.get_by_label("Text of the note").fill("here it differs")
    page.get_by_label("Text of the note").press("Enter")

    def noted():
        found = client.recordings.events(tuesday.identifier)
        return [event for event in found if event.kind == "note"]

    assert wait_until(noted)
    (note,) = noted()
    assert note.text == "here it differs"
    assert note.until - note.time == pytest.approx(tuesday.duration / 2, rel=0.1)
    marks = f"() => {PLOTS}[0].plot.markers.map(({{text}}) => text)"
    assert wait_until(lambda: "A: here it differs" in page.evaluate(marks))


@pytest.mark.usefixtures("compared")
def test_a_colleague_opens_the_link_and_sees_the_same(
    workspace, browser, running_station
):
    page, area = workspace.page, _area(workspace)
    page.mouse.click(area["x"] + 0.4 * area["width"], area["y"] + 30)
    moment = page.evaluate(f"() => {PLOTS}[0].plot.fixed")
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    workspace.button("plots", "Copy link").click()
    page.get_by_role("button", name="Copied", exact=True).wait_for()
    link = page.evaluate("() => navigator.clipboard.readText()")
    with logged_in(browser, running_station, begin=without_scene) as other:
        other.goto("about:blank")
        other.goto(link)
        there = WorkspacePage(other).dock("plots").locator(".plot").first
        there.get_by_text("1 B").wait_for()
        fixed = other.evaluate(f"() => {PLOTS}[0].plot.fixed")
        assert fixed == pytest.approx(moment, abs=1e-3)


def test_layouts_of_plots_are_kept_at_the_station_and_in_files(
    workspace, client, tmp_path
):
    page, dock = workspace.page, workspace.dock("plots")
    labels = (
        "() => [...document.querySelectorAll('.plot .chart')].map((e) => e.ariaLabel)"
    )
    before = page.evaluate(labels)
    dock.locator(".layouts > summary").click()
    page.get_by_label("Name of the layout").fill("both")
    page.get_by_label("Name of the layout").press("Enter")
    dock.get_by_role("button", name="both", exact=True).wait_for()
    (position, _) = client.plot_layouts.get("both").plots
    assert position.keys[0] == "position/panda_joint1"
    with page.expect_download() as download:
        workspace.button("plots", "Export").click()
    file = tmp_path / "one.json"
    plots = json.loads(Path(download.value.path()).read_text())["plots"]
    file.write_text(json.dumps({"plots": [{**plots[0], "transform": "spectrum"}]}))
    with page.expect_file_chooser() as chooser:
        workspace.button("plots", "Import").click()
    chooser.value.set_files(file)
    page.wait_for_function(f"() => {PLOTS}.length === 1 && {PLOTS}[0].plot.isSpectrum")
    dock.get_by_role("button", name="both", exact=True).click()
    page.wait_for_function(f"() => {PLOTS}.length === 2")
    assert page.evaluate(labels) == before
    workspace.button("plots", "Delete the layout both").click()
    assert wait_until(lambda: client.plot_layouts.names() == [])
    dock.locator(".layouts > summary").click()


def test_a_file_is_uploaded_or_refused_with_the_reason(workspace, enabled, tmp_path):
    own = _record(enabled, "own", 0.1)
    whole, cut = tmp_path / "tuesday of the cell.mcap", tmp_path / "cut.mcap"
    enabled.recordings.download(own.identifier, whole)
    kept = whole.read_bytes()
    cut.write_bytes(kept[: len(kept) // 2])
    workspace.button("timeline", "Recordings").click()
    for file in (whole, cut):
        with workspace.page.expect_file_chooser() as chooser:
            workspace.button("timeline", "Upload …").click()
        chooser.value.set_files(file)
        workspace.button("timeline", "Upload …").wait_for()
    line = workspace.page.locator("#refusal-line")
    line.get_by_text("The file was not kept: it is not whole").wait_for()
    (found,) = (one for one in enabled.recordings.list() if one.is_uploaded)
    assert (found.name, found.cycles) == ("tuesday_of_the_cell", own.cycles)
    row = workspace.dock("timeline").locator(".row", has_text=found.name)
    assert "uploaded" in row.inner_text()
    row.get_by_role("button", name=f"Replay {found.identifier}").click()
    workspace.dock("plots").get_by_text(found.name, exact=True).wait_for()
    workspace.button("plots", "End replay").click()
    enabled.recordings.delete(found.identifier)
    workspace.button("timeline", "Events").click()


def test_the_moment_of_an_incident_is_linked_in_three_clicks(workspace, enabled):
    workspace.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    known = {one.identifier for one in enabled.incidents.list()}
    enabled.stop("a test")

    def new():
        found = enabled.incidents.list()
        # Listed while it is written; its length and file are there at the end.
        done = [one for one in found if one.state != "recording"]
        return [one for one in done if one.identifier not in known]

    assert wait_until(new, 20.0)
    (incident,) = new()
    enabled.release_stop()
    enabled.release_stop(arm=True)
    workspace.button("timeline", "Incidents").click()
    workspace.button("timeline", f"Replay {incident.identifier}").click()
    (cause,) = enabled.incidents.events(incident.identifier)
    page = workspace.page
    page.wait_for_function(f"() => {PLOTS}[0].plot.fixed !== null")
    fixed = page.evaluate(f"() => {PLOTS}[0].plot.fixed")
    assert fixed == pytest.approx(incident.duration - 2.0, abs=0.01)
    marks = page.evaluate(f"() => {PLOTS}[0].plot.markers")
    assert [(m["text"], m["at"]) for m in marks] == [(cause.text, fixed)]
    assert f"#incident={incident.identifier}&t={fixed:.3f}" in page.url
    workspace.button("plots", "Copy link").click()
    assert counted("show a colleague the moment of a reflex") == 3
    workspace.button("plots", "Play").click()
    page.wait_for_function(f"(at) => {PLOTS}[0].plot.fixed > at + 0.2", arg=fixed)
    workspace.button("plots", "End replay").click()
    workspace.button("timeline", "Events").click()
