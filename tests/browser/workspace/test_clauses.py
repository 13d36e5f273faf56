"""What a person does in the docks beyond the usual tasks, checked at the station."""

import math
import re

import pytest

from tests.browser.workspace_page import (
    CONTROLLER,
    position,
    run_alone,
    wait_until,
)

pytestmark = pytest.mark.long

EYE = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]
KIND = "effort_controllers/JointGroupPositionController"


def _desired(client, joint):
    """Return where the default controller was last told to move a joint [rad]."""
    return client.last_command(CONTROLLER).last[joint - 1]


def _type(workspace, joint, text):
    workspace.type_into("joints", f"Command of joint{joint}", text)


def test_a_named_pose_is_kept_by_the_station_and_gone_back_to(workspace, enabled):
    page = workspace.page
    workspace.button("joints", "rad").click()
    before = position(enabled, "panda_joint1")
    dock = workspace.dock("joints")
    dock.get_by_label("Name of the pose").fill("home of the test")
    workspace.button("joints", "Save pose").click()
    assert wait_until(lambda: "poses" in enabled.waypoint_paths.names())
    _type(workspace, 1, f"{before + 0.3:.4f}")
    assert wait_until(lambda: position(enabled, "panda_joint1") > before + 0.25)
    page.reload()
    dock.get_by_label("Pose", exact=True).select_option("home of the test")
    page.wait_for_function("() => !document.querySelector('.joints input').disabled")
    workspace.button("joints", "Go").click()
    if dock.locator(".far").is_visible():
        dock.get_by_role("button", name="Move there").click()
    assert wait_until(lambda: abs(position(enabled, "panda_joint1") - before) < 0.02)
    workspace.button("joints", "Forget").click()
    dock.get_by_label("Pose", exact=True).get_by_text("none saved yet").wait_for(
        state="attached"
    )
    assert "poses" not in enabled.waypoint_paths.names()


def test_the_top_speed_holds_for_typed_values(workspace, enabled):
    dock = workspace.dock("joints")
    slider = dock.get_by_label("Top speed in degrees per second")
    slider.evaluate(
        "(e) => { e.value = 6; e.dispatchEvent(new Event('input', {bubbles: true})); }"
    )
    workspace.button("joints", "deg").click()
    start = math.degrees(_desired(enabled, 7) or position(enabled, "panda_joint7"))
    began = enabled.status().time
    _type(workspace, 7, f"{start - 3.0:.3f}")
    wanted = math.radians(round(start - 3.0, 3))
    assert wait_until(lambda: abs(_desired(enabled, 7) - wanted) < 1e-9)
    assert enabled.status().time - began > 0.9 * 3.0 / 6.0
    slider.evaluate(
        "(e) => { e.value = 29; e.dispatchEvent(new Event('input', {bubbles: true})); }"
    )


def test_parameters_are_written_as_yaml_and_a_wrong_one_is_refused(workspace, client):
    dock = workspace.dock("controllers")
    workspace.button("controllers", "Load …").click()
    dock.get_by_label("Search controller types").fill("effort group position")
    dock.get_by_role("option", name=KIND).click()
    dock.get_by_label("Name of the controller").fill("written")
    dock.get_by_role("button", name="Edit as YAML").click()
    text = dock.get_by_label("Parameters in YAML")
    good = text.input_value()
    text.fill("joints: [panda_joint1")
    dock.get_by_role("button", name="Load", exact=True).click()
    line = workspace.page.locator("#refusal-line")
    line.get_by_text("The text is not valid YAML").wait_for()
    text.fill(good.replace("p: 600", "p: 611"))
    dock.get_by_role("button", name="Load", exact=True).click()
    assert wait_until(lambda: "written" in [c.name for c in client.controllers()])
    assert client.gains("written").values["panda_joint1/p"] == 611
    workspace.button("controllers", "Unload written").click()
    assert wait_until(lambda: "written" not in [c.name for c in client.controllers()])


def test_yaml_and_fields_are_two_views_of_the_same_values(workspace, client):
    dock = workspace.dock("controllers")
    workspace.button("controllers", "Load …").click()
    dock.get_by_label("Search controller types").fill("effort group position")
    dock.get_by_role("option", name=KIND).click()
    dock.get_by_label("Name of the controller").fill("viewed")
    field = dock.get_by_label("panda_joint1 / pid / p", exact=True)
    field.fill("613")
    dock.get_by_role("button", name="Edit as YAML").click()
    text = dock.get_by_label("Parameters in YAML")
    assert wait_until(lambda: "p: 613" in text.input_value()), text.input_value()
    good = text.input_value()
    text.fill(good.replace("p: 613", "p: ["))
    dock.get_by_role("button", name="Edit as fields").click()
    line = workspace.page.locator("#refusal-line")
    line.get_by_text("The text is not valid YAML").wait_for()
    assert text.is_visible()
    text.fill(good.replace("p: 613", "p: 617"))
    dock.get_by_role("button", name="Edit as fields").click()
    field.wait_for()
    assert field.input_value() == "617"
    dock.get_by_role("button", name="Load", exact=True).click()
    assert wait_until(lambda: "viewed" in [c.name for c in client.controllers()])
    assert client.gains("viewed").values["panda_joint1/p"] == 617
    client.unload_controller("viewed")


def test_a_chain_is_drawn_from_its_first_controller_to_its_last(workspace, client):
    joints = [f"panda_joint{i}" for i in range(1, 8)]
    kind = "position_controllers/JointTrajectoryController"
    pid = {"dof_names": joints, "command_interface": "effort"}
    measured = {"reference_and_state_interfaces": ["position", "velocity"]}
    gains = {"gains": {j: {"p": 300.0, "d": 20.0} for j in joints}}
    client.load_controller(
        "below", "pid_controller/PidController", pid | measured | gains
    )
    client.load_controller("above", kind, {"joints": [f"below/{j}" for j in joints]})
    dock = workspace.dock("controllers")
    dock.get_by_text("○ above → ○ below").wait_for()
    run_alone(client, "below", "above")
    dock.get_by_text("● above → ● below (chained)").wait_for()
    client.switch_controllers(stop=["above", "below"])
    client.unload_controller("above")
    client.unload_controller("below")
    dock.get_by_text("above →").wait_for(state="detached")


def test_a_running_controller_is_restarted_in_its_row(workspace, enabled):
    told = []
    workspace.page.on(
        "response", lambda r: r.url.endswith("/switch") and told.append(r.json())
    )
    workspace.button("controllers", f"Restart {CONTROLLER}").click()
    assert wait_until(lambda: workspace.page.wait_for_timeout(50) or len(told) == 2)
    assert [told[0]["stopped"], told[1]["started"]] == [[CONTROLLER], [CONTROLLER]]
    assert enabled.controller(CONTROLLER).state == "running"


def test_thresholds_load_and_end_effector_are_set_as_in_franka_desk(workspace, client):
    run_alone(client)
    dock = workspace.dock("move")
    dock.get_by_text("Arm: collision thresholds").click()
    panda = client.robot("panda")
    turned = [0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, *EYE[8:12], 0.0, 0.0, 0.02, 1.0]
    panda.set_EE_frame(turned)
    _shows(
        dock.get_by_label("End effector in the nominal frame: x, y, z"), "0, 0, 0.02"
    )
    _shows(dock.get_by_label("Load: mass"), "0")
    dock.get_by_label("Load: mass").fill("0.35")
    dock.get_by_role("button", name="Set Load").click()
    assert wait_until(lambda: panda.state().m_load == pytest.approx(0.35)), (
        workspace.page.locator("#log").text_content()
    )
    dock.get_by_label("End effector in the nominal frame: x, y, z").fill("0, 0, 0.05")
    dock.get_by_role("button", name="Set End effector").click()
    assert wait_until(lambda: panda.state().NE_T_EE[14] == pytest.approx(0.05))
    assert panda.state().NE_T_EE[:12] == pytest.approx(turned[:12])
    since = client.events(limit=1)[-1].id
    wanted = {"contact torque": 20, "collision torque": 40, "contact force": 33}
    for label, value in {**wanted, "collision force": 50}.items():
        dock.get_by_label(f"Collision thresholds: {label}").fill(str(value))
    dock.get_by_role("button", name="Set Collision thresholds").click()

    def asked():
        what = "PUT /robots/panda/force_torque_collision_behavior"
        return [e.result for e in client.events(since, limit=1000) if e.what == what]

    assert wait_until(asked)
    assert asked()[-1].startswith("20")
    dock.get_by_label("Load: mass").fill("0")
    dock.get_by_role("button", name="Set Load").click()
    assert wait_until(lambda: panda.state().m_load == pytest.approx(0.0))
    panda.set_EE_frame(EYE)
    _shows(dock.get_by_label("End effector in the nominal frame: x, y, z"), "0, 0, 0")
    _guiding_is_what_the_arm_says(dock, panda)
    dock.get_by_text("Arm: collision thresholds").click()


def _shows(field, text):
    """Wait until a field has a text that nobody typed."""
    assert wait_until(lambda: field.input_value() == text), field.input_value()


def _guiding_is_what_the_arm_says(dock, panda):
    guide = dock.get_by_role("button", name=re.compile("^Guiding"))
    guide.click()
    assert wait_until(lambda: panda.errors().robot_mode == "guiding")
    dock.get_by_text("Guiding off").wait_for()
    panda.guiding(pressed=False)
    dock.get_by_text("Guiding on").wait_for()


def test_the_hand_is_jogged_while_a_button_is_held(workspace, client):
    dock = workspace.dock("move")
    dock.get_by_text("Hand: jog and target").click()
    dock.get_by_role("button", name="Start hand jog").click()
    up = dock.get_by_role("button", name="Move the hand along z while held", exact=True)
    workspace.page.wait_for_function(
        "() => !document.querySelector('.jog button').disabled"
    )
    panda = client.robot("panda")
    (jog,) = (
        c.name
        for c in client.controllers()
        if c.type.endswith("CartesianJogController") and c.state == "running"
    )
    dock.get_by_label("Axes of the jog").select_option("the end effector")
    assert wait_until(lambda: client.gains(jog).values["frame"] == 1)
    dock.get_by_text("in the axes of the end effector").wait_for()
    client.set_gains(jog, {"frame": 0})
    dock.get_by_text("in the axes of the base").wait_for()
    speed = dock.get_by_label("Top speed of the hand")
    fastest = client.last_command(jog).elements[0].maximum
    assert wait_until(lambda: float(speed.get_attribute("max")) == fastest)
    speed.fill("0.08")
    before = panda.state().O_T_EE[14]
    up.hover()
    workspace.page.mouse.down()
    assert wait_until(lambda: panda.state().O_T_EE[14] > before + 0.015)
    # A page that stutters lets go, and takes the button up again.
    fast = pytest.approx(0.08)
    assert wait_until(lambda: client.last_command(jog).last[2] == fast)
    workspace.page.mouse.up()
    assert wait_until(lambda: abs(max(panda.state().dq, key=abs)) < 0.01)
    dock.get_by_text("Hand: jog and target").click()


def test_waypoints_are_named_reordered_and_removed(workspace, enabled):
    dock = workspace.dock("move")
    for joint1 in ("0.05", "0.2"):
        workspace.button("joints", "rad").click()
        _type(workspace, 1, joint1)
        assert wait_until(
            lambda v=joint1: abs(position(enabled, "panda_joint1") - float(v)) < 0.01
        )
        count = dock.locator("ol.waypoints li").count()
        workspace.button("move", "+ Capture").click()
        dock.locator("ol.waypoints li").nth(count).wait_for()
    paths = enabled.waypoint_paths

    def names():
        return [one.name for one in paths.get("path-1").waypoints]

    assert len(names()) == 2
    name = dock.get_by_label("Name of waypoint 1", exact=True)
    name.fill("near")
    name.press("Enter")
    assert wait_until(lambda: names()[0] == "near")
    dock.get_by_role("button", name="Move down: near").click()
    assert wait_until(lambda: names()[1] == "near")
    dock.get_by_role("button", name="Remove: near").click()
    assert wait_until(lambda: "near" not in names())
    workspace.button("move", "Delete").click()
    assert wait_until(lambda: paths.names() == [])


def test_the_speed_of_the_simulation_and_its_reset_are_the_stations(workspace, enabled):
    dock = workspace.dock("simulation")
    state = enabled.simulation.state
    for typed in ("0.5", "1"):
        field = dock.get_by_label("Speed of simulated time")
        field.fill(typed)
        field.press("Enter")
        assert wait_until(lambda t=typed: state().real_time_factor == float(t))
    workspace.button("joints", "rad").click()
    _type(workspace, 1, "0.4")
    assert wait_until(lambda: position(enabled, "panda_joint1") > 0.35)
    epoch = enabled.status().epoch
    workspace.button("simulation", "Reset").click()
    assert wait_until(lambda: enabled.status().epoch > epoch)
    assert wait_until(lambda: abs(position(enabled, "panda_joint1")) < 0.05)
