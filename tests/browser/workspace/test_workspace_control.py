"""Control of the station, taken and given back on the page."""

from contextlib import suppress

import pytest

from station.client import ApiError
from station.wire import ExternalForce, Fault
from tests.browser.workspace_page import (
    CONTROLLER,
    OTHER,
    allow_motion,
    position,
    run_alone,
    wait_until,
)

pytestmark = pytest.mark.slow


def test_who_holds_control_acts_and_others_are_refused(workspace, in_control):
    assert in_control.lease.state().owner == "ada"
    with pytest.raises(ApiError, match="ada holds control"):
        in_control.reset_loop_statistics()
    running = in_control.controller(OTHER).state == "running"
    name = f"Stop {OTHER}" if running else f"Start {OTHER}"
    workspace.button("controllers", name).click()
    assert wait_until(
        lambda: (in_control.controller(OTHER).state == "running") != running
    )
    workspace.page.locator("#stop").click()
    assert wait_until(lambda: in_control.status().stop_state == "stopped")
    bar = workspace.page.locator("#bar")
    bar.get_by_role("button", name="Release stop").click()
    bar.get_by_role("button", name="Allow motion").click()
    assert wait_until(lambda: in_control.status().stop_state == "armed")


def test_a_refused_release_is_logged_with_what_helps(workspace, enabled):
    page = workspace.page
    enabled.stop("A test.")
    taken = enabled.lease.take("grace")
    enabled.lease.act_under(taken.lease)
    page.locator("#bar").get_by_role("button", name="Release stop").click()
    line = page.locator("#refusal-line")
    line.get_by_text("grace holds control").wait_for()
    line.get_by_role("button", name="Take control …").wait_for()
    assert enabled.status().stop_state == "stopped"
    enabled.release_stop()
    enabled.release_stop(arm=True)
    enabled.lease.release()
    page.locator("#control").get_by_text("any operator").wait_for()


def test_no_lease_reaches_the_page(workspace, in_control):
    told = workspace.page.evaluate(
        "async () => (await Promise.all(['/workspace/control', '/api/v1/control']"
        ".map(async (p) => await (await fetch(p)).text()))).join()"
    )
    assert '"owner":"ada"' in told
    assert "lease" not in told
    assert "not_forwarded" in told
    assert in_control.lease.state().owner == "ada"


def test_control_is_offered_and_given_back(workspace, in_control):
    page = workspace.page
    page.locator("#control").click()
    panel = page.locator("#control-panel")
    panel.get_by_label("Hand over to").fill("grace")
    panel.get_by_role("button", name="Offer").click()
    panel.get_by_text("Offered to grace").wait_for()
    assert in_control.lease.state().hand_over_to == "grace"
    panel.get_by_role("button", name="Give back").click()
    assert wait_until(lambda: in_control.lease.state().owner is None)
    panel.get_by_role("button", name="Close").click()


def test_a_jog_ends_when_control_is_taken_and_is_taken_back_by_force(
    workspace, enabled
):
    page = workspace.page
    button = workspace.button("joints", "Move joint7 up while held")
    button.hover()
    page.mouse.down()
    before = position(enabled, "panda_joint7")
    assert wait_until(lambda: position(enabled, "panda_joint7") > before + 0.05)
    taken = enabled.lease.take("grace", force=True)
    line = page.locator("#refusal-line")
    line.get_by_text("grace holds control").wait_for(timeout=3000)
    rest = enabled.last_command(CONTROLLER).last
    page.wait_for_timeout(400)
    assert enabled.last_command(CONTROLLER).last == rest
    page.mouse.up()
    line.get_by_role("button", name="Take control …").click()
    page.get_by_label("Your name").fill("ada")
    assert enabled.lease.state().lease is None
    page.get_by_role("button", name="Yes, take it from grace").click()
    assert wait_until(lambda: enabled.lease.state().owner == "ada")
    assert taken.lease
    page.locator("#control").get_by_text("you (ada)").wait_for()  # the panel has closed
    page.locator("#control").click()
    page.get_by_role("button", name="Give back").click()
    assert wait_until(lambda: enabled.lease.state().owner is None)
    page.locator("#control-panel").get_by_role("button", name="Close").click()


def _idle(page, *docks):
    """Return the labels of the disabled buttons that some docks show."""
    return set(
        page.evaluate(
            "(docks) => docks.flatMap((dock) => [...document.querySelectorAll("
            "`[data-dock=${dock}] button:disabled`)].map((b) => "
            "b.ariaLabel || b.textContent.trim()))",
            docks,
        )
    )


def test_buttons_that_can_do_nothing_are_disabled(workspace, client):
    page = workspace.page
    run_alone(client)
    with suppress(ApiError):
        while True:
            client.gain_sets.undo()
    expected = {
        "simulation": {"End faults", "Step"},
        "tuning": {"Undo", "Run test", "Find gains by relay", "Apply"},
        "gripper": set(),
    }
    for dock, labels in expected.items():
        workspace.dock(dock)
        assert wait_until(lambda d=dock, n=labels: n <= _idle(page, d)), dock
    client.set_gains(CONTROLLER, {"panda_joint1/p": 500.0})
    client.robot("panda").inject(Fault(kind="stuck_joint", joint=7, cycles=10**6))
    run_alone(client, CONTROLLER)
    workspace.dock("simulation")
    assert wait_until(lambda: _idle(page, "simulation") == {"Step"})
    workspace.dock("tuning")
    ready = {"Undo", "Run test", "Find gains by relay"}
    assert wait_until(lambda: not ready & _idle(page, "tuning"))
    page.locator("#stop").click()
    start = f"Start {OTHER}"
    assert wait_until(lambda: {start, "Open"} <= _idle(page, "controllers", "gripper"))
    assert wait_until(lambda: "Run test" in _idle(page, "tuning"))
    allow_motion(client)
    assert wait_until(lambda: start not in _idle(page, "controllers"))
    client.lease.act_under(client.lease.take("grace", ttl=60.0).lease)
    assert page.locator("#watching").get_by_role("button").is_enabled()
    changing = {start, f"Unload {OTHER}", "Close", "Hold still", "Undo"}
    docks = "controllers", "gripper", "tuning"
    assert wait_until(lambda: changing <= _idle(page, *docks))
    client.gain_sets.undo()
    client.robot("panda").clear_faults()
    client.lease.release()
    assert wait_until(lambda: start not in _idle(page, "controllers"))


def test_a_long_push_that_a_script_began_is_ended(workspace, client):
    panda = client.robot("panda")
    push = ExternalForce(link="panda_hand", force=[0.0, 0.0, 5.0], duration=600.0)
    panda.apply_force(push)
    workspace.dock("simulation")
    assert wait_until(lambda: "End faults" not in _idle(workspace.page, "simulation"))
    workspace.button("simulation", "End faults").click()
    assert wait_until(lambda: panda.faults() == [])
