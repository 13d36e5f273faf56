"""The dock *Joints*: what its fields, buttons and keys move, and what ends a motion."""

import math

import pytest

from tests.browser.workspace_page import CONTROLLER, let_pass, position, wait_until

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
    joints.type_into(
        "joints", "Command of joint1", f"{here - math.copysign(1.5, here)}"
    )
    assert _moves(enabled, 1)
    label = page.evaluate("() => document.activeElement.getAttribute('aria-label')")
    assert label == "Command of joint1"
    page.keyboard.press(" ")  # a letter of what is typed
    assert enabled.status().stop_state == "armed"
    page.keyboard.press("Escape")
    assert wait_until(lambda: enabled.status().stop_state == "stopped")
    page.locator("#motion").get_by_text("STOPPED").wait_for()
    page.wait_for_function("() => document.querySelector('.joints input').disabled")


def test_a_held_button_that_a_stop_disables_has_to_be_pressed_anew(joints, enabled):
    page = joints.page
    button = joints.button("joints", "Move joint7 up while held")
    button.hover()
    page.mouse.down()
    assert _moves(enabled, 7)
    enabled.stop("A test.")
    page.wait_for_function("() => document.querySelector('.joints .hold').disabled")
    assert page.locator(".hold.held").count() == 0
    enabled.release_stop()
    enabled.release_stop(arm=True)
    enabled.switch_controllers(start=[CONTROLLER])
    page.wait_for_function("() => !document.querySelector('.joints .hold').disabled")
    assert let_pass(enabled, 0.3)
    assert enabled.last_command(CONTROLLER).last is None  # The button is still held.
    page.mouse.up()


def test_enter_in_a_field_that_nobody_edited_moves_nothing(joints, enabled):
    field = joints.dock("joints").get_by_label("Command of joint3", exact=True)
    field.focus()
    start = _told(enabled, 3)
    given = list(enabled.controller_state(CONTROLLER).desired)
    enabled.command(CONTROLLER, [*given[:2], start + 0.25, *given[3:]])
    shown = f"{start + 0.25:.4f}"
    joints.page.wait_for_function(
        "(text) => document.activeElement.value === text", arg=shown
    )
    field.press("Enter")
    enabled.command(CONTROLLER, [None, None, start, *[None] * 4])
    assert wait_until(lambda: field.input_value() == f"{start:.4f}")
    field.press("Enter")
    assert enabled.last_command(CONTROLLER).last[2] == start
    joints.page.keyboard.type(f"{start + 0.1:.4f}")  # over what is selected
    field.press("Enter")
    assert wait_until(lambda: abs(_told(enabled, 3) - start - 0.1) < 1e-4)


def test_the_top_speed_of_a_motion_changes_while_it_runs(joints, enabled):
    slider = joints.dock("joints").get_by_label("Top speed in degrees per second")

    def set_speed(degrees):
        slider.evaluate(
            "(e, v) => { e.value = v; e.dispatchEvent(new Event('input')); }", degrees
        )

    start = _told(enabled, 6)
    target = start + math.copysign(1.0, 1.5 - start)
    set_speed(2)
    joints.type_into("joints", "Command of joint6", str(target))
    assert wait_until(lambda: abs(_told(enabled, 6) - start) > 1e-3)
    set_speed(85)
    assert wait_until(lambda: abs(_told(enabled, 6) - target) < 1e-9, seconds=6)
    set_speed(29)


def test_sliders_are_enabled_once_however_often_the_button_is_pressed(joints, enabled):
    page = joints.page
    enabled.switch_controllers(stop=[CONTROLLER])
    button = page.locator("#enable")
    button.wait_for()
    held = []

    def keep(route):
        held.append(route)

    page.route("**/controllers/switch", keep)
    button.click()
    assert wait_until(lambda: page.wait_for_timeout(50) or held)
    assert button.is_disabled()
    page.evaluate("import('/static/lib/store.js').then((m) => m.enableSliders())")
    page.wait_for_function("() => document.querySelector('#enable').disabled")
    assert len(held) == 1
    held[0].continue_()
    page.unroute("**/controllers/switch")
    button.wait_for(state="hidden")
    assert enabled.controller(CONTROLLER).state == "running"


def test_a_click_into_a_value_that_was_sent_selects_it_whole(joints, enabled):
    joints.button("joints", "deg").click()
    field = joints.dock("joints").get_by_label("Command of joint3", exact=True)
    keyboard = joints.page.keyboard
    assert wait_until(field.input_value)  # where the controller was told to be
    joints.type_into("joints", "Command of joint3", "0")
    assert wait_until(lambda: abs(_told(enabled, 3)) < 1e-9)
    for digit in "325":  # the pointer stays in the field
        field.click()
        keyboard.type(digit)
        keyboard.press("Enter")
        wanted = math.radians(int(digit))
        wait_until(lambda wanted=wanted: abs(_told(enabled, 3) - wanted) < 1e-9)
        log = joints.page.locator("#log-count").inner_text()
        assert _told(enabled, 3) == pytest.approx(wanted, abs=1e-9), (
            field.input_value(),
            log,
        )
        assert field.input_value() == digit


def test_a_click_into_what_is_being_typed_sets_the_caret(joints, enabled):
    joints.button("joints", "deg").click()
    before = _told(enabled, 3)
    field = joints.dock("joints").get_by_label("Command of joint3", exact=True)
    field.click()
    joints.page.keyboard.type("12")
    field.click(position={"x": 20, "y": 8})
    joints.page.keyboard.type("9")
    assert "9" in field.input_value()
    assert len(field.input_value()) == 3
    joints.page.keyboard.press("Tab")
    assert _told(enabled, 3) == before


def test_a_far_value_shows_its_ghost_before_it_moves_anything(joints, enabled):
    page, here = joints.page, _told(enabled, 1)
    joints.button("joints", "deg").click()
    dock = joints.dock("joints")
    field, question = (
        dock.get_by_label("Command of joint1", exact=True),
        dock.locator(".far"),
    )
    far = math.degrees(here) - math.copysign(40, here)
    field.click()
    page.keyboard.type(f"{far:.1f}")
    with page.expect_response("**/ui/ghost") as shown:
        page.keyboard.press("Enter")
    (wanted,) = shown.value.request.post_data_json["positions"].values()
    assert math.degrees(wanted) == pytest.approx(far, abs=0.06)
    question.get_by_text("This moves joint1 by 40.").wait_for()
    assert _told(enabled, 1) == here
    with page.expect_response("**/ui/ghost") as hidden:
        question.get_by_role("button", name="Leave it").click()
    assert hidden.value.request.method == "DELETE"
    page.keyboard.type(f"{far:.1f}")  # the focus stayed in the field
    page.keyboard.press("Enter")
    question.wait_for()
    page.keyboard.press("Enter")
    question.wait_for(state="hidden")
    assert wait_until(lambda: abs(_told(enabled, 1) - wanted) < 1e-9)


def test_a_stop_during_a_motion_is_no_refusal(joints, enabled):
    page, here = joints.page, _told(enabled, 4)
    joints.button("joints", "rad").click()
    joints.type_into("joints", "Command of joint4", f"{here - 0.33:.3f}")
    assert _moves(enabled, 4)
    before = page.locator("#log-count").inner_text()
    page.locator("#stop").click()
    page.locator("#motion").get_by_text("STOPPED").wait_for()
    page.wait_for_function("() => document.querySelector('.joints input').disabled")
    assert page.locator("#log-count").inner_text() == before
    assert page.locator("#notice").is_hidden()
