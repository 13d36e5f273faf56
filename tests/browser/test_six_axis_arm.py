"""The workspace of a six-axis arm without gripper, used as a person would."""

from pathlib import Path

import pytest

from station.client import StationClient
from tests.browser.conftest import run_station
from tests.browser.workspace_page import (
    WorkspacePage,
    position,
    wait_until,
    without_scene,
)

pytestmark = pytest.mark.long

CONFIG = Path(__file__).parents[2] / "examples" / "ur5.yaml"
KIND = "position_controllers/JointGroupPositionController"


@pytest.fixture(scope="module")
def arm(browser, tmp_path_factory):
    """Yield the page of a UR5, and a client of its station."""
    with run_station(tmp_path_factory.mktemp("ur5"), str(CONFIG)) as running:
        context = browser.new_context(viewport={"width": 1280, "height": 800})
        without_scene(context)
        page = context.new_page()
        page.goto(f"{running.ui}/login?token={running.token}")
        with StationClient(running.api, running.token) as client:
            yield WorkspacePage(page), client
        context.close()


def test_without_gripper_and_force_estimate_there_is_neither_dock_nor_key(arm):
    workspace, _ = arm
    page = workspace.page
    assert workspace.dock("joints").is_visible()
    page.locator('.dock[data-dock="gripper"]').wait_for(state="hidden")
    assert page.locator('.dock[data-dock="simulation"]').is_visible()
    key = page.locator("#view-tools .key")
    key.get_by_text("contact", exact=True).wait_for()
    assert key.get_by_text("force on the arm", exact=True).is_hidden()


def test_a_typed_angle_moves_the_joint_and_nothing_speaks_of_external_torque(arm):
    workspace, client = arm
    dock = workspace.dock("joints")
    assert dock.get_by_role("columnheader", name="τext").count() == 0
    workspace.page.get_by_role("button", name="Enable sliders").click()
    label = dock.locator("tbody th").first.inner_text()
    joint = client.joint_states().name[0]
    workspace.button("joints", "rad").click()
    wanted = position(client, joint) + 0.1
    field = dock.get_by_label(f"Command of {label}", exact=True)
    workspace.page.wait_for_function(
        "() => !document.querySelector('.joints input').disabled"
    )
    assert wait_until(field.input_value)  # where the joint was told to be is known
    field.fill(f"{wanted:.4f}")
    field.press("Enter")
    assert wait_until(lambda: abs(position(client, joint) - wanted) < 0.005)


def test_types_for_franka_arms_are_not_offered_and_others_can_be_loaded(arm):
    workspace, client = arm
    dock = workspace.dock("controllers")
    workspace.button("controllers", "Load …").click()
    dock.get_by_role("option", name=KIND, exact=True).wait_for()
    search = dock.get_by_label("Search controller types")
    search.fill("franka")
    assert dock.get_by_role("option").count() == 0
    dock.get_by_text("No type has “franka” in its name").wait_for()
    search.fill("group position")
    dock.get_by_role("option", name=KIND, exact=True).click()
    dock.get_by_label("Name of the controller").fill("mine")
    dock.get_by_role("button", name="Load and start", exact=True).click()
    assert wait_until(
        lambda: any(
            c.name == "mine" and c.state == "running" for c in client.controllers()
        )
    )


@pytest.mark.parametrize("typed", ["abc", "1.5", "0", ""])
def test_a_number_of_cycles_that_is_none_is_refused_in_words(arm, typed):
    workspace, client = arm
    client.simulation.pause()
    try:
        step = workspace.button("simulation", "Step")
        assert wait_until(step.is_enabled)
        before = client.status().simulation.time
        workspace.dock("simulation").get_by_label("Cycles to step").fill(typed)
        step.click()
        refusal = f"“{typed}” is not a whole number of cycles."
        workspace.page.locator("#refusal-line").get_by_text(refusal).first.wait_for()
        assert client.status().simulation.time == before
    finally:
        client.simulation.resume()


def test_every_number_is_found_by_its_name(arm):
    workspace, _ = arm
    box = workspace.dock("plots").locator(".plot").first
    box.locator(".picker > summary").click()
    box.get_by_label("Search channels").fill("p99")
    found = box.locator("details.source .channel", has_text="p99")
    found.first.wait_for()
    rate = found.first.get_by_role("button").last
    assert rate.evaluate("(e) => e.getClientRects().length") == 1
    assert rate.inner_text() == "d/dt"
