"""The dock Plots: pause, marks, legend, and what is kept when the page is reloaded."""

import math
import re
from pathlib import Path

import pytest

from tests.browser.workspace_page import CONTROLLER, WorkspacePage, let_pass, wait_until

pytestmark = pytest.mark.long


@pytest.fixture
def in_radians(workspace):
    """The page shows angles as the station has them."""
    workspace.button("joints", "rad").click()
    yield
    workspace.button("joints", "deg").click()


def test_a_plot_is_paused_zoomed_measured_and_saved(workspace, enabled):
    page, dock = workspace.page, workspace.dock("plots")
    box = dock.locator(".plot").first
    plot = "document.querySelector('st-plots').plots[0].plot"
    page.wait_for_function(f"() => {plot}.traces[0].history.times.length > 12")
    workspace.button("plots", "Pause").click()
    end = page.evaluate(f"() => {plot}.end")
    canvas = box.locator(".chart")
    canvas.focus()
    span = page.evaluate(f"() => {plot}.span")
    canvas.press("+")
    assert page.evaluate(f"() => {plot}.span") < span
    canvas.press("ArrowLeft")
    canvas.press("Enter")
    for _ in range(10):
        canvas.press("ArrowRight")
    page.wait_for_function(f"() => {plot}.fixed !== null && {plot}.cursor !== null")
    assert let_pass(enabled, 0.1)
    assert page.evaluate(f"() => {plot}.end") == end
    # More than a minute later the picture of the pause is still there.
    page.evaluate(
        "(later) => document.querySelector('st-plots')"
        ".history('position/panda_joint1').add(later, 1)",
        arg=end + 200,
    )
    canvas.press("-")
    box.locator(".picker > summary").click()
    with page.expect_download() as download:
        box.get_by_role("button", name="CSV", exact=True).click()
    rows = Path(download.value.path()).read_text().splitlines()
    assert rows[0].startswith("time [s],q joint1 [°],q joint2 [°]")
    assert len(rows) > 10
    assert float(rows[9].split(",")[2]) == pytest.approx(-45.0, abs=1.0)
    box.locator(".picker > summary").click()
    workspace.button("plots", "Resume").click()
    page.wait_for_function(f"() => {plot}.end === null")


def test_switches_and_gains_are_marked_in_the_plots(workspace, enabled):
    page = workspace.page
    dock = workspace.dock("tuning")
    dock.get_by_label("Controller to tune").select_option(CONTROLLER)
    dock.get_by_label("Joint to tune").select_option("panda_joint7")
    dock.get_by_label("d of panda_joint7").fill("4.5")
    workspace.button("tuning", "Apply").click()
    assert wait_until(lambda: enabled.gains(CONTROLLER).values["panda_joint7/d"] == 4.5)
    workspace.button("tuning", "Undo").click()
    enabled.switch_controllers(stop=[CONTROLLER])
    marks = "document.querySelector('st-plots').plots[0].plot.markers.map(m => m.text)"
    for text in ("gains panda_joint7/d", "gains undone", f"{CONTROLLER} stopped"):
        page.wait_for_function(
            f"(text) => {marks}.some((mark) => mark.includes(text))", arg=text
        )
    # Restarts are told too, although they are shorter than the page's own looks.
    for _ in range(2):
        enabled.switch_controllers(start=[CONTROLLER])
        enabled.switch_controllers(stop=[CONTROLLER])
    stamps = [event.stamp for event in enabled.events(kinds=["switch"], limit=4)]
    assert len(stamps) == 4
    at = marks.replace("m.text", "m.at")
    assert wait_until(lambda: page.evaluate(at)[-4:] == stamps)


def test_no_two_of_many_traces_look_the_same_and_the_legend_shows_how(workspace):
    page = workspace.page
    looks = page.evaluate(
        "async () => { const {dashOf} = await import('/static/lib/plot.js');"
        " return [...Array(28).keys()].map((i) => `${i % 7} ${dashOf(i)}`); }"
    )
    assert len(set(looks)) == 28
    workspace.dock("plots")
    # In one step: the lines are drawn anew while the plots are.
    dashes = page.evaluate(
        "() => [...document.querySelector('.plot').querySelectorAll('.trace line')]"
        ".map((line) => getComputedStyle(line).strokeDasharray)"
    )
    assert dashes[:3] == ["none", "6px, 3px", "2px, 3px"]


def test_plots_and_their_channels_survive_a_reload(workspace):
    page = workspace.page
    workspace.button("plots", "+ plot").click()
    boxes = workspace.dock("plots").locator(".plot")
    added = boxes.nth(2)
    added.locator(".picker > summary").click()
    for name in ("dq joint2 [°/s]", "rate of change of τ joint3"):
        added.get_by_role("button", name=name, exact=True).click()
    added.get_by_role("button", name="XY", exact=True).click()
    shown = (
        "() => [...document.querySelectorAll('.plot .chart')].map((e) => e.ariaLabel)"
    )
    before = page.evaluate(shown)
    assert before[2] == "Plot of dq joint2, d/dt τ joint3"
    page.reload()
    boxes = WorkspacePage(page).dock("plots").locator(".plot")
    boxes.nth(2).wait_for()
    assert page.evaluate(shown) == before
    boxes.nth(2).locator(".picker > summary").click()
    across = boxes.nth(2).get_by_role("button", name="XY", exact=True)
    assert across.get_attribute("aria-pressed") == "true"
    boxes.nth(2).get_by_role("button", name="✕", exact=True).click()
    assert boxes.count() == 2


@pytest.mark.usefixtures("in_radians")
def test_cursors_and_zoom_are_those_of_all_plots_and_the_legend_tells_values(
    workspace, enabled
):
    page, dock = workspace.page, workspace.dock("plots")
    plots = "document.querySelector('st-plots').plots"
    page.wait_for_function(f"() => {plots}[0].plot.traces[0].history.times.length > 90")
    box = dock.locator(".plot").first
    area = box.locator(".u-over").bounding_box()
    right = area["x"] + 0.9 * area["width"]
    middle = area["y"] + 0.5 * area["height"]
    page.mouse.move(right, middle)
    workspace.button("plots", "Pause").press("Enter")
    heads = dock.locator(".legend b")
    heads.nth(1).get_by_text(" at ").wait_for()  # the other plot has it, too
    times = [
        float(text.split(" at ")[1].split()[0]) for text in heads.all_inner_texts()
    ]
    assert times[0] == pytest.approx(times[1], abs=0.02)
    shown = box.locator(".trace output").all_inner_texts()
    box.locator(".picker > summary").press("Enter")
    with page.expect_download() as download:
        box.get_by_role("button", name="CSV", exact=True).press("Enter")
    box.locator(".picker > summary").press("Enter")
    rows = [
        [float(cell) for cell in line.split(",")]
        for line in Path(download.value.path()).read_text().splitlines()[1:]
    ]
    nearest = min(rows, key=lambda row: abs(row[0] - times[0]))
    assert [float(text) for text in shown] == pytest.approx(nearest[1:], abs=6e-5)
    # At rest, what is measured is what the station says.
    position = enabled.joint_states().position[: len(shown)]
    assert [float(text) for text in shown] == pytest.approx(position, abs=5e-3)
    page.mouse.move(area["x"] + 0.5 * area["width"], middle)
    page.mouse.down()
    page.mouse.move(right, middle, steps=4)
    page.mouse.up()
    spans = f"() => {plots}.map(({{plot}}) => plot.span)"
    assert page.evaluate(spans) == pytest.approx([4.0, 4.0], rel=0.05)
    assert page.evaluate(f"() => {plots}[0].plot.fixed") is None  # no click
    page.mouse.dblclick(right, middle)
    assert page.evaluate(spans) == [10, 10]
    workspace.button("plots", "Resume").click()


@pytest.mark.usefixtures("in_radians")
def test_a_channel_is_dragged_from_one_plot_to_another(workspace, client):
    page, dock = workspace.page, workspace.dock("plots")
    boxes = dock.locator(".plot")
    named = "() => [...document.querySelectorAll('.plot .chart')].map(e => e.ariaLabel)"
    before = page.evaluate(named)
    assert "q joint4" in before[0]
    trace = boxes.first.locator(".trace").nth(3)
    trace.drag_to(boxes.nth(1).locator(".chart"))
    after = page.evaluate(named)
    assert "q joint4" not in after[0]
    assert after[1] == before[1] + ", q joint4"
    page.mouse.move(5, 5)
    shown = boxes.nth(1).locator(".trace output").last
    wanted = client.joint_states().position[3]
    assert wait_until(lambda: abs(float(shown.inner_text()) - wanted) < 5e-3)
    boxes.nth(1).locator(".trace").last.drag_to(boxes.first.locator(".chart"))
    assert page.evaluate(named)[1] == before[1]


@pytest.mark.usefixtures("in_radians")
def test_differences_and_the_norm_of_channels_are_kept_with_the_plot(workspace, client):
    page = workspace.page
    box = workspace.dock("plots").locator(".plot").first
    box.locator(".picker > summary").click()
    show = box.get_by_label("Show", exact=True)
    show.select_option("minus the first")
    box.locator(".picker > summary").click()
    page.mouse.move(5, 5)
    named = box.locator(".chart").get_attribute("aria-label")
    first = int(re.search("\N{MINUS SIGN} q joint([1-7])", named).group(1))
    joints = client.joint_states().position[:7]
    others = [q for i, q in enumerate(joints, 1) if i != first]

    def tells(wanted):
        shown = box.locator(".trace output").all_inner_texts()
        # A channel that is new has no value yet.
        values = sorted(
            float(text) for text in shown if text not in {"", "\N{EN DASH}"}
        )
        return values == pytest.approx(sorted(wanted), abs=5e-3)

    assert wait_until(lambda: tells([q - joints[first - 1] for q in others]))
    box.locator(".picker > summary").click()
    show.select_option("norm of all")
    assert wait_until(lambda: tells([math.hypot(*joints)]))
    page.reload()
    box = WorkspacePage(page).dock("plots").locator(".plot").first
    assert wait_until(lambda: tells([math.hypot(*joints)]))
    box.locator(".picker > summary").click()
    box.get_by_label("Show", exact=True).select_option("channels as they are")
    assert wait_until(lambda: tells(joints))
