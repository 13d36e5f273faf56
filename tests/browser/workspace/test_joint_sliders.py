"""The sliders of the dock *Joints*, dragged, clicked and pressed as a hand does."""

import math

import pytest

from tests.browser.workspace_page import CONTROLLER, let_pass, position, wait_until

pytestmark = pytest.mark.slow
JOINT = "panda_joint1"


@pytest.fixture
def slider(workspace, enabled):
    """The slider of joint 1 while its controller runs."""
    assert enabled.controller(CONTROLLER).state == "running"
    workspace.button("joints", "deg").click()
    slider = workspace.dock("joints").get_by_role("slider", name="Slider of joint1")
    # It follows what the controller is told, once that is known.
    workspace.page.wait_for_function(
        "() => document.querySelector('.slider').ariaDisabled === 'false'"
        " && !document.querySelector('.slider .command').hidden"
    )
    return slider


def _told(client):
    return client.controller_state(CONTROLLER).desired[0]


def _settled(client):
    """Return what the joint is told after half a second without a change."""
    while True:
        before = _told(client)
        let_pass(client, 0.5)
        if _told(client) == before:
            return before


def _thumb(slider):
    """Return the middle of the thumb [px], and the pixels of a radian."""
    thumb = slider.locator(".thumb").bounding_box()
    low, high = (
        float(slider.get_attribute(f"aria-value{end}")) for end in ("min", "max")
    )
    scale = slider.bounding_box()["width"] / (high - low)
    return thumb["x"] + thumb["width"] / 2, thumb["y"] + thumb["height"] / 2, scale


def test_a_slider_shows_the_limits_and_follows_the_joint(slider, workspace, enabled):
    low, high = (
        float(slider.get_attribute(f"aria-value{end}")) for end in ("min", "max")
    )
    element = enabled.last_command(CONTROLLER).elements[0]
    assert (low, high) == (element.minimum, element.maximum)
    ends = slider.locator("xpath=..").locator("small").all_inner_texts()
    assert ends == [f"{math.degrees(q):.1f}°" for q in (low, high)]
    workspace.button("joints", "rad").click()
    assert (
        slider.locator("xpath=..").locator("small").first.inner_text().endswith("rad")
    )
    x, _, scale = _thumb(slider)
    start = _told(enabled)
    enabled.command(CONTROLLER, [start + 0.2, *[None] * 6])  # by somebody else
    assert wait_until(lambda: abs(_thumb(slider)[0] - x - 0.2 * scale) < 1.0)
    assert wait_until(lambda: abs(position(enabled, JOINT) - start - 0.2) < 0.02)


def test_a_joint_follows_the_thumb_and_stays_where_it_is_let_go(
    slider, workspace, enabled
):
    mouse, (x, y, scale) = workspace.page.mouse, _thumb(slider)
    start = _told(enabled)
    mouse.move(x, y)
    mouse.down()
    with workspace.page.expect_response("**/ui/ghost") as ghost:
        mouse.move(x + 0.3 * scale, y, steps=5)
    (wanted,) = ghost.value.request.post_data_json["positions"]
    assert wanted == JOINT
    assert wait_until(lambda: _told(enabled) > start + 0.1)  # while it is held
    mouse.move(x - 0.2 * scale, y, steps=5)
    with workspace.page.expect_request(
        lambda r: r.url.endswith("/ui/ghost") and r.method == "DELETE"
    ):
        mouse.up()
    # The pointer stays where it was.
    assert wait_until(lambda: abs(_settled(enabled) - start + 0.2) < 1.5 / scale)


def test_keys_move_a_joint_by_steps(slider, workspace, enabled):
    start = _told(enabled)
    slider.focus()
    for _ in range(3):
        workspace.page.keyboard.press("ArrowRight")
    assert wait_until(lambda: abs(_told(enabled) - start - math.radians(3)) < 1e-9)
    workspace.page.keyboard.press("Shift+ArrowLeft")
    assert wait_until(lambda: abs(_told(enabled) - start - math.radians(2.9)) < 1e-9)
    assert slider.get_attribute("aria-valuetext").endswith("°")


def test_a_click_far_from_the_thumb_asks_first(slider, workspace, enabled):
    page, (x, y, scale) = workspace.page, _thumb(slider)
    start = _told(enabled)
    sign = -math.copysign(1.0, start or 1.0)
    page.mouse.click(x + sign * 0.6 * scale, y)
    question = workspace.dock("joints").locator(".far")
    question.get_by_text("This moves joint1 by 34.").wait_for()
    assert _told(enabled) == start
    question.get_by_role("button", name="Move there").click()
    assert wait_until(
        lambda: abs(_told(enabled) - start - sign * 0.6) < 1.5 / scale, seconds=6
    )


def test_a_stop_takes_the_thumb_out_of_the_hand(slider, workspace, enabled):
    page, (x, y, scale) = workspace.page, _thumb(slider)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 0.1 * scale, y, steps=3)
    page.keyboard.press("Escape")
    assert wait_until(lambda: enabled.status().stop_state == "stopped")
    page.wait_for_function(
        "() => document.querySelector('.slider').ariaDisabled === 'true'"
    )
    here = position(enabled, JOINT)
    enabled.release_stop()
    enabled.release_stop(arm=True)
    enabled.switch_controllers(start=[CONTROLLER])
    page.wait_for_function(
        "() => document.querySelector('.slider').ariaDisabled === 'false'"
    )
    page.mouse.move(x + 0.5 * scale, y, steps=3)
    page.mouse.up()
    assert let_pass(enabled, 0.3)
    assert abs(position(enabled, JOINT) - here) < 0.02
