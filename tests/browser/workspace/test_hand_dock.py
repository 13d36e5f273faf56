"""The hand in *Waypoints and moves*: steps of a button, and a typed pose."""

import math

import pytest

from tests.browser.workspace_page import let_pass, run_alone, wait_until

pytestmark = pytest.mark.long
TARGETS = "cartesian_streaming_controller"


@pytest.fixture
def hand(workspace, client):
    """The dock while the hand takes targets, in degrees and the axes of the base."""
    run_alone(client, TARGETS)
    workspace.button("joints", "deg").click()
    dock = workspace.dock("move")
    if not dock.get_by_role("button", name="Here", exact=True).is_visible():
        dock.get_by_text("Hand: jog and target").click()
    dock.get_by_text(f"{TARGETS} moves the hand to a pose").wait_for()
    dock.get_by_label("Step of the hand").select_option(index=1)
    dock.get_by_label("Axes of the jog").select_option("the base")
    workspace.page.wait_for_function(
        "() => document.querySelector('st-hand').live.place !== null"
    )
    return dock


def _told(client):
    return client.controller_state(TARGETS).desired


def _press(dock, way):
    dock.get_by_role("button", name=f"Move the hand {way} by one step").click()


def test_presses_of_a_button_move_the_hand_by_exact_steps(hand, client):
    before = _told(client)
    for _ in range(3):  # faster than the hand is
        _press(hand, "against z")
    assert wait_until(lambda: abs(_told(client)[2] - before[2] + 0.003) < 1e-6)
    assert _told(client)[:2] == pytest.approx(before[:2], abs=1e-9)
    assert _told(client)[3:] == pytest.approx(before[3:], abs=1e-9)


def test_a_held_button_makes_one_step(hand, workspace, client):
    before = _told(client)
    hand.get_by_role("button", name="Move the hand along y by one step").hover()
    workspace.page.mouse.down()
    assert wait_until(lambda: abs(_told(client)[1] - before[1] - 0.001) < 1e-6)
    assert let_pass(client, 0.5)
    workspace.page.mouse.up()
    assert _told(client)[1] == pytest.approx(before[1] + 0.001, abs=1e-6)


def test_a_step_along_the_axes_of_the_hand_is_another_one(hand, client):
    state = client.robot("panda").state().O_T_EE
    along = state[8:11]  # the hand's z axis in the base
    before = _told(client)
    hand.get_by_label("Axes of the jog").select_option("the end effector")
    _press(hand, "along z")
    wanted = [p + 0.001 * a for p, a in zip(before, along, strict=False)]
    assert wait_until(lambda: math.dist(_told(client)[:3], wanted) < 2e-5)


def test_a_step_about_an_axis_turns_the_hand_by_a_degree(hand, client):
    before = _told(client)
    _press(hand, "along about z")

    def turned():
        cosine = abs(
            sum(a * b for a, b in zip(before[3:], _told(client)[3:], strict=True))
        )
        return 2.0 * math.degrees(math.acos(min(1.0, cosine)))

    assert wait_until(lambda: abs(turned() - 1.0) < 1e-3)
    assert _told(client)[:3] == pytest.approx(before[:3], abs=1e-6)


def test_a_typed_pose_is_reached_with_its_orientation(hand, workspace, client):
    keyboard = workspace.page.keyboard
    yaw = hand.get_by_label("Hand yaw", exact=True)
    for angle in (10, 4):  # twice into the same field; the pointer stays
        hand.get_by_role("button", name="Here", exact=True).click()
        hand.get_by_label("Hand roll", exact=True).fill("180")
        hand.get_by_label("Hand pitch", exact=True).fill("0")
        yaw.click()
        keyboard.type(str(angle))
        keyboard.press("Enter")
        # Half a turn about x, then the yaw about z.
        half = math.radians(angle) / 2.0
        wanted = [math.cos(half), math.sin(half), 0.0, 0.0]

        def is_there(wanted=wanted):
            return (
                abs(sum(a * b for a, b in zip(wanted, _told(client)[3:], strict=True)))
                > 1 - 1e-9
            )

        assert wait_until(is_there, seconds=6)
    workspace.button("joints", "rad").click()
    assert yaw.input_value() == f"{math.radians(4):.4f}"
    for angle in ("roll", "pitch", "yaw"):
        hand.get_by_label(f"Hand {angle}", exact=True).fill("")
    before = _told(client)
    x = hand.get_by_label("Hand x [m]")
    x.fill(f"{before[0] - 0.02:.4f}")
    x.press("Enter")
    assert wait_until(lambda: abs(_told(client)[0] - before[0] + 0.02) < 1e-4)
    assert _told(client)[3:] == pytest.approx(before[3:], abs=1e-6)


def test_a_typed_pose_is_tried_and_made_as_it_was_tried(hand, client):
    before = client.robot("panda").state().O_T_EE[12:15]
    wanted = [before[0] + 0.1, before[1] + 0.15, before[2] - 0.05]
    for axis, value in zip("xyz", wanted, strict=True):
        hand.get_by_label(f"Hand {axis} [m]", exact=True).fill(f"{value:.4f}")
    for tried in ("Go around", "Rehearse"):
        hand.locator("st-hand").get_by_role("button", name=tried, exact=True).click()
        forecast = hand.locator("st-hand .forecast")
        forecast.get_by_text("would be completed").wait_for()
        still = client.robot("panda").state().O_T_EE[12:15]
        assert still == pytest.approx(before, abs=0.005)  # nothing has moved
    forecast.get_by_role("button", name="Move as rehearsed").click()

    def is_there():
        return client.robot("panda").state().O_T_EE[12:15] == pytest.approx(
            wanted, abs=0.01
        )

    assert wait_until(is_there)
