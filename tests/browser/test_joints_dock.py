"""The dock *Joints*: what its fields, buttons and keys move, and what ends a motion."""

import math

import pytest

from tests.browser.workspace_page import CONTROLLER, position, wait_until

pytestmark = pytest.mark.slow


@pytest.fixture
def joints(workspace, enabled):
    """The dock in radians while its controller runs; motion is allowed afterwards."""
    workspace.button("joints", "rad").click()
    yield workspace
    if enabled.status().stop_state != "armed":
        enabled.release_stop()
        enabled.release_stop(arm=True)


def _told(client, joint):
    """Return where the default controller was last told to move a joint [rad]."""
    last = client.last_command(CONTROLLER).last
    return position(client, f"panda_joint{joint}") if last is None else last[joint - 1]


def _moves(client, joint):
    """Wait until a joint moves; return whether it does."""
    before = position(client, f"panda_joint{joint}")
    return wait_until(
        lambda: abs(position(client, f"panda_joint{joint}") - before) > 0.03
    )


def test_escape_stops_while_the_field_of_a_typed_value_has_the_focus(joints, enabled):
    page = joints.page
    here = position(enabled, "panda_joint1")
    joints.type_into("joints", "Command of joint1", f"{here - math.copysign(1.5, here)}")
    assert _moves(enabled, 1)
    label = page.evaluate("() => document.activeElement.getAttribute('aria-label')")
    assert label == "Command of joint1"
    page.keyboard.press(" ")  # a letter of what is typed
    assert enabled.status().stop_state == "armed"
    page.keyboard.press("Escape")
    assert wait_until(lambda: enabled.status().stop_state == "stopped")
    page.locator("#motion").get_by_text("STOPPED").wait_for()
