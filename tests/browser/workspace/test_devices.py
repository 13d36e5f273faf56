"""A gamepad moves the hand, and a key captures waypoints while an arm is guided."""

import pytest

from tests.browser.workspace_page import (
    WorkspacePage,
    let_pass,
    run_alone,
    wait_until,
)

pytestmark = pytest.mark.long

JOG = "cartesian_jog_controller"
DEAD_MAN, STOP = 5, 1
PAD = """
window.pad = {mapping: "standard", axes: [0, 0, 0, 0],
              buttons: Array.from({length: 17}, () => ({pressed: false}))};
navigator.getGamepads = () => [window.pad];
"""


@pytest.fixture
def page(open_tab, client):
    """The page with a gamepad, whose map is in sight, while the hand can be jogged."""
    run_alone(client, JOG)
    with open_tab(lambda tab: tab.add_init_script(PAD)) as page:
        dock = WorkspacePage(page).dock("move")
        dock.get_by_text("Gamepad", exact=True).click()
        dock.get_by_text("the hand moves only meanwhile").wait_for()
        yield page


def _place(client):
    return client.robot("panda").state().O_T_EE[12]


def _press(page, button, *, pressed=True):
    page.evaluate("([i, is]) => { pad.buttons[i].pressed = is; }", [button, pressed])


def test_a_stick_moves_the_hand_only_while_the_dead_man_button_is_held(page, client):
    page.evaluate("() => { pad.axes[1] = -1; }")
    said = page.locator("st-gamepad")
    said.get_by_text("1.00").first.wait_for()  # It is heard,
    before = _place(client)
    assert let_pass(client, 0.5)
    assert _place(client) == pytest.approx(before, abs=1e-5)  # and moves nothing.
    _press(page, DEAD_MAN)
    assert wait_until(lambda: _place(client) > before + 0.01)
    _press(page, DEAD_MAN, pressed=False)
    assert wait_until(lambda: max(map(abs, client.last_command(JOG).last)) == 0.0)
    _press(page, STOP)
    assert wait_until(lambda: client.status().stop_state == "stopped")
    client.release_stop(arm=False)
    client.release_stop(arm=True)


def test_a_key_captures_a_waypoint_only_while_the_arm_is_guided(page, client):
    page.keyboard.press("c")
    panda = client.robot("panda")
    client.switch_controllers(start=[], stop=[JOG])
    panda.guiding(pressed=True)
    page.wait_for_function("() => document.querySelector('st-path').guided")
    page.keyboard.press("c")
    assert wait_until(lambda: "path-1" in client.waypoint_paths.names())
    panda.guiding(pressed=False)
    assert len(client.waypoint_paths.get("path-1").waypoints) == 1
