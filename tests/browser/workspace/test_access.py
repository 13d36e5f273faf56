"""The page for people without a mouse, and for people who see little or no colour."""

from pathlib import Path

import axe_core_python
import pytest

from tests.browser.workspace_page import (
    CONTROLLER,
    allow_motion,
    position,
    run_alone,
    wait_until,
    without_scene,
)

pytestmark = pytest.mark.slow

AXE = Path(axe_core_python.__file__).parent / "axe.min.js"
RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"]
FOCUSABLE = (
    "button:not(:disabled), input:not(:disabled), select:not(:disabled), a[href],"
    " textarea:not(:disabled), summary, [tabindex='0']"
)


@pytest.fixture(scope="module")
def all_open(workspace):
    """The page with every dock and every fold open."""
    page = workspace.page
    # High enough for all docks: a dock that is opened folds those without room.
    page.set_viewport_size({"width": 1280, "height": 3000})
    # A dock is hidden where its part is not there: this station has no cameras.
    docks = page.locator(".dock:visible")
    names = docks.evaluate_all("all => all.map((d) => d.dataset.dock)")
    assert {"joints", "controllers", "plots", "timeline"} < set(names)
    for name in names:
        workspace.dock(name)
    skip = page.get_by_role("button", name="Skip the tour")
    if skip.is_visible():
        skip.click()
    page.evaluate(
        "() => document.querySelectorAll('main details').forEach((d) => d.open = true)"
    )
    page.locator("#log-button").click()
    page.locator("#control").click()
    workspace.button("controllers", "Load …").click()
    return workspace


@pytest.fixture
def stopped(client):
    """The station is stopped, until the test has ended in whatever way."""
    client.stop("A rehearsal.")
    yield
    allow_motion(client)


@pytest.mark.long
@pytest.mark.usefixtures("stopped")
def test_axe_finds_nothing_in_any_dock_light_or_dark(all_open):
    page = all_open.page
    all_open.button("timeline", "Alarms").click()
    page.evaluate(AXE.read_text())
    found = []
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        page.wait_for_timeout(200)
        told = page.evaluate(
            "(tags) => axe.run(document, {runOnly: {type: 'tag', values: tags},"
            " iframes: false, resultTypes: ['violations']})",
            RULES,
        )
        found += [
            f"{scheme} {broken['id']}: {node['target']} {node['failureSummary']}"
            for broken in told["violations"]
            for node in broken["nodes"]
        ]
    page.emulate_media(color_scheme="light")
    assert found == []


@pytest.mark.long
def test_tab_reaches_everything_and_moves_nothing(all_open, enabled):
    page = all_open.page
    before = enabled.last_command(CONTROLLER).last
    asked = []
    page.on(
        "request",
        lambda r: (
            r.method != "GET"
            and '"dry_run":true' not in (r.post_data or "")
            and asked.append(r.url)
        ),
    )
    wanted = page.evaluate(
        """(focusable) => {
            document.activeElement.blur();
            const all = [...document.querySelectorAll(focusable)].filter((e) =>
                e.checkVisibility({visibilityProperty: true}) && e.tabIndex >= 0);
            window.reached = new Set();
            addEventListener("focusin", (event) => window.reached.add(event.target));
            window.wanted = all;
            return all.length;
        }""",
        FOCUSABLE,
    )
    for _ in range(wanted + 40):
        page.keyboard.down("Tab")  # held: it repeats, in half the messages
    page.keyboard.up("Tab")
    missed = page.evaluate(
        "() => window.wanted.filter((e) => e.isConnected && !window.reached.has(e)"
        " && !e.disabled && e.checkVisibility({visibilityProperty: true}))"
        ".map((e) => e.outerHTML.slice(0, 120))"
    )
    assert missed == []
    assert [url for url in asked if not url.endswith("/ui/ghost")] == []
    assert enabled.last_command(CONTROLLER).last == before


@pytest.mark.long
def test_keys_move_the_robot_only_while_a_focused_button_is_held(all_open, enabled):
    page = all_open.page
    page.evaluate("() => document.activeElement.blur()")
    before = enabled.last_command(CONTROLLER).last
    keys = ["ArrowUp", "ArrowLeft", "PageDown", "Enter", "a", "j", "+", "-", "F2"]
    for key in keys:
        page.keyboard.press(key)
    field = all_open.dock("joints").get_by_label("Command of joint1", exact=True)
    field.focus()
    for key in ("ArrowUp", "ArrowDown", "PageUp", "Tab"):
        page.keyboard.press(key)
    all_open.dock("joints").locator("input[type=range]").first.press("ArrowRight")
    page.wait_for_timeout(300)
    assert enabled.last_command(CONTROLLER).last == before
    button = all_open.button("joints", "Move joint7 up while held")
    button.focus()
    here = position(enabled, "panda_joint7")
    page.keyboard.down("Enter")
    assert wait_until(lambda: position(enabled, "panda_joint7") > here + 0.03)
    page.keyboard.up("Enter")
    page.wait_for_timeout(200)
    rest = enabled.last_command(CONTROLLER).last
    page.wait_for_timeout(300)
    assert enabled.last_command(CONTROLLER).last == rest


@pytest.fixture
def login(browser, running_station):
    """The form of the login, in a browser of its own."""
    context = browser.new_context()
    without_scene(context)
    page = context.new_page()
    page.goto(f"{running_station.ui}/login")
    yield page
    context.close()


def test_the_keyboard_alone_leads_from_the_login_to_stop(
    login, running_station, client
):
    run_alone(client)  # so that the sliders are offered
    keyboard = login.keyboard
    for text in ("ada", running_station.token):
        keyboard.type(text)
        keyboard.press("Tab")
    keyboard.press("Enter")
    login.wait_for_selector('#bar[data-link="live"]')

    def tab_to(where):
        for _ in range(60):
            keyboard.press("Tab")
            if where.evaluate("(e) => e === document.activeElement"):
                return
        raise AssertionError(where)

    tab_to(login.locator("#stop"))
    tab_to(login.locator("#enable"))
    keyboard.press("Enter")
    assert wait_until(lambda: client.controller(CONTROLLER).state == "running")
    here = position(client, "panda_joint1")
    tab_to(login.get_by_role("button", name="Move joint1 up while held"))
    keyboard.down("Enter")
    assert wait_until(lambda: position(client, "panda_joint1") > here + 0.03)
    keyboard.press("Escape")
    assert wait_until(lambda: client.status().stop_state == "stopped")
    keyboard.up("Enter")
    allow_motion(client)
    # The name is asked once: lessons have it, too.
    assert login.locator("st-lessons input.name").input_value() == "ada"
