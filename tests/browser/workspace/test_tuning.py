"""The dock Tuning: gains as the station has them, whoever changed them, and sets."""

import pytest

from tests.browser.workspace_page import CONTROLLER, OTHER, wait_until

pytestmark = pytest.mark.slow

GAIN = "panda_joint2/p"


@pytest.fixture
def field(workspace, enabled):
    """The field of a gain, which has the value that the station has."""
    assert enabled
    dock = workspace.dock("tuning")
    dock.get_by_label("Controller to tune").select_option(CONTROLLER)
    dock.get_by_label("Joint to tune").select_option("panda_joint2")
    return dock.get_by_label("p of panda_joint2")


def _with_an_old_revision(route):
    old = {"if-match": '"0"'} if route.request.method == "PATCH" else {}
    route.continue_(headers={**route.request.headers, **old})


def _shows(field, value):
    """Return whether a field comes to show a value that nobody typed into it."""
    return wait_until(lambda: float(field.input_value()) == value)


def test_gains_changed_by_a_script_are_shown_but_not_where_somebody_types(
    workspace, enabled, field
):
    before = enabled.gains(CONTROLLER).values
    enabled.set_gains(CONTROLLER, {GAIN: before[GAIN] - 10})
    assert _shows(field, before[GAIN] - 10)
    field.fill("555")
    damping = workspace.dock("tuning").get_by_label("d of panda_joint2")
    enabled.set_gains(CONTROLLER, before)
    enabled.set_gains(CONTROLLER, {"panda_joint2/d": 31.5})
    assert _shows(damping, 31.5)
    assert field.input_value() == "555"
    enabled.set_gains(CONTROLLER, before)
    field.fill(str(before[GAIN]))


def test_a_change_of_gains_that_were_others_meanwhile_is_not_lost(
    workspace, enabled, field
):
    before = enabled.gains(CONTROLLER).values
    field.fill("560")
    # As if a script had been faster than the news of its change.
    page, path = workspace.page, f"**/controllers/{CONTROLLER}/gains"
    page.route(path, _with_an_old_revision)
    workspace.button("tuning", "Apply").click()
    dock = workspace.dock("tuning")
    dock.get_by_text("Somebody has changed these gains meanwhile").wait_for()
    assert enabled.gains(CONTROLLER).values == before
    assert field.input_value() == "560"
    page.unroute(path)
    workspace.button("tuning", "Apply").click()
    assert wait_until(lambda: enabled.gains(CONTROLLER).values[GAIN] == 560)
    enabled.set_gains(CONTROLLER, before)


def test_a_controller_that_starts_does_not_take_what_was_typed(
    workspace, enabled, field
):
    page = workspace.page
    field.fill("570")
    enabled.switch_controllers(start=[OTHER], stop=[CONTROLLER])
    page.wait_for_function(
        "async (name) => (await import('/static/lib/store.js')).store"
        ".docks.operated.names[0] === name",
        arg=OTHER,
    )
    chosen = workspace.dock("tuning").get_by_label("Controller to tune")
    assert (chosen.input_value(), field.input_value()) == (CONTROLLER, "570")
    field.fill(str(enabled.gains(CONTROLLER).values[GAIN]))
    assert wait_until(lambda: chosen.input_value() == OTHER)


def test_a_gain_that_is_an_enumeration_is_chosen_by_name(workspace, client):
    name = next(
        c.name
        for c in client.controllers()
        if c.type.endswith("CartesianJogController")
    )
    dock = workspace.dock("tuning")
    dock.get_by_label("Controller to tune").select_option(name)
    assert client.gains(name).values["frame"] == 0
    dock.get_by_label(f"frame of {name}").select_option("1")
    workspace.button("tuning", "Apply").click()
    assert wait_until(lambda: client.gains(name).values["frame"] == 1)
    workspace.button("tuning", "Undo").click()
    assert wait_until(lambda: client.gains(name).values["frame"] == 0)


def test_a_set_of_gains_is_saved_compared_and_applied(workspace, enabled):
    dock = workspace.dock("tuning")
    name = "panda_joint2/p"
    before = enabled.gains(CONTROLLER).values[name]
    dock.get_by_text("Sets of gains").click()
    for label in ("Apply set", "Delete", "Save"):
        assert workspace.button("tuning", label).is_disabled()
    dock.get_by_label("Name of the set").fill("my set")
    dock.get_by_role("button", name="Save", exact=True).click()
    line = workspace.page.locator("#refusal-line")
    line.get_by_text("“my set” cannot be the name of a set").wait_for()
    assert enabled.gain_sets.names() == []
    dock.get_by_label("Name of the set").fill("test-set")
    dock.get_by_role("button", name="Save", exact=True).click()
    dock.get_by_text("no gain differs").wait_for()
    enabled.set_gains(CONTROLLER, {name: before - 50})
    dock.get_by_text(f"{name}: set {before:.4f}, now {before - 50:.4f}").wait_for()
    dock.get_by_role("button", name="Apply set").click()
    assert wait_until(lambda: enabled.gains(CONTROLLER).values[name] == before)
    dock.get_by_role("button", name="Delete", exact=True).click()
    assert wait_until(lambda: enabled.gain_sets.names() == [])
    dock.get_by_text("Sets of gains").click()
