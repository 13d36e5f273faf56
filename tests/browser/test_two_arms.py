"""Two arms of one station, moved and tuned on the page."""

from pathlib import Path

import pytest
import yaml

from station.ui.page.controller_offers import example_parameters
from tests.browser.conftest import run_station
from tests.browser.workspace_page import position, wait_until

pytestmark = pytest.mark.long

CONFIG = Path(__file__).parents[2] / "examples/dual_panda.yaml"
GROUP = "effort_controllers/JointGroupPositionController"
ARMS = ("panda_1", "panda_2")


@pytest.fixture(scope="module")
def running_station(tmp_path_factory):
    """A station with two Pandas, of which nothing that moves runs."""
    with run_station(tmp_path_factory.mktemp("station"), str(CONFIG)) as running:
        yield running


def _enable(workspace, client, names):
    """Click the button of the first minute; wait until these controllers run."""
    workspace.page.get_by_role("button", name="Enable sliders").click()

    def states():
        return {c.name: c.state for c in client.controllers() if c.type == GROUP}

    assert wait_until(lambda: {n for n, s in states().items() if s == "running"})
    running = {name for name, state in states().items() if state == "running"}
    assert names is None or running == set(names)
    workspace.page.wait_for_function(
        "() => [...document.querySelectorAll('.joints input')].every(i => !i.disabled)"
    )
    return running


def _jog(workspace, client, arm):
    """Hold the button of an arm's last joint until the joint has moved."""
    joint = f"{arm}_joint7"
    before = position(client, joint)
    label = f"Move {joint.removeprefix('panda_')} up while held"
    workspace.button("joints", label).hover()
    workspace.page.mouse.down()
    assert wait_until(lambda: position(client, joint) > before + 0.05)
    workspace.page.mouse.up()


def _type(workspace, client, arm, value):
    """Type a place of an arm's first joint; wait until it is there."""
    label = f"Command of {arm.removeprefix('panda_')}_joint1"
    workspace.button("joints", "rad").click()
    workspace.type_into("joints", label, str(value))
    joint = f"{arm}_joint1"
    assert wait_until(lambda: abs(position(client, joint) - value) < 0.02)


def _nothing_failed(client):
    assert [(c.name, c.fault) for c in client.controllers() if c.fault] == []
    assert {a.robot_mode for a in client.status().robots} <= {"move", "idle"}


def test_one_controller_moves_both_arms(workspace, client):
    (name,) = _enable(workspace, client, None)
    for arm in ARMS:
        _jog(workspace, client, arm)
        _type(workspace, client, arm, 0.15)
    assert len(client.last_command(name).last) == 14
    _nothing_failed(client)
    client.switch_controllers(stop=[name])


def test_each_arm_has_a_controller_of_its_own(workspace, client):
    _load_own(client)
    for old in client.controllers():
        if old.type == GROUP and not old.name.startswith("panda_"):
            client.unload_controller(old.name)
    title = "() => document.querySelector('#enable').title.includes('panda_2_position')"
    workspace.page.wait_for_function(title)
    _enable(workspace, client, ["panda_1_position", "panda_2_position"])
    first, second = (f"{arm}_position" for arm in ARMS)
    before = client.last_command(first).last
    _type(workspace, client, "panda_2", -0.15)
    assert wait_until(lambda: client.last_command(second).last[0] == -0.15)
    assert client.last_command(first).last == before
    for arm in ARMS:
        _jog(workspace, client, arm)
    state = workspace.dock("joints").locator(".state")
    state.get_by_text("panda_1_position and panda_2_position take values").wait_for()
    _nothing_failed(client)


def test_a_controller_of_the_chosen_arm_is_loaded(workspace, client):
    kind = "franka_example_controllers/CartesianImpedanceExampleController"
    dock = workspace.dock("controllers")
    workspace.button("controllers", "Load …").click()
    dock.get_by_label("Search controller types").fill("CartesianImpedance")
    dock.get_by_role("option", name=kind).click()
    dock.get_by_label("Arm of the controller").select_option("panda_2")
    names = dock.get_by_label("joint_names", exact=True)
    assert wait_until(lambda: names.input_value().startswith("panda_2_joint1, "))
    dock.get_by_label("Name of the controller").fill("of_two")
    dock.get_by_role("button", name="Load", exact=True).click()
    assert wait_until(lambda: "of_two" in [c.name for c in client.controllers()])
    claims = client.controller("of_two").claimed_resources
    joints = {name for claim in claims for name in claim.resources}
    assert joints == {f"panda_2_joint{i}" for i in range(1, 8)}
    client.unload_controller("of_two")


def _parameters(joints):
    return yaml.safe_load(example_parameters(GROUP, joints))


def _load_own(client):
    """Load a controller of its own for each arm; return their names."""
    for arm in ARMS:
        joints = [f"{arm}_joint{i}" for i in range(1, 8)]
        client.load_controller(f"{arm}_position", GROUP, _parameters(joints))
    return [f"{arm}_position" for arm in ARMS]


def _run_own(client):
    """Run the controllers of `_load_own` alone, whatever ran before."""
    own = _load_own(client)
    running = {c.name for c in client.controllers() if c.state == "running"}
    others = {c.name for c in client.controllers() if c.type == GROUP} - set(own)
    if waiting := [name for name in own if name not in running]:
        client.switch_controllers(start=waiting, stop=[*others & running])


@pytest.mark.parametrize("arm", ARMS)
def test_each_arm_is_tuned(workspace, client, arm):
    _run_own(client)
    name, joint = f"{arm}_position", f"{arm}_joint6"
    dock = workspace.dock("tuning")
    dock.get_by_label("Controller to tune").select_option(name)
    dock.get_by_label("Joint to tune").select_option(joint)
    before = client.gains(name).values
    dock.get_by_label(f"p of {joint}").fill("140.5")
    workspace.button("tuning", "Apply").click()
    assert wait_until(lambda: client.gains(name).values[f"{joint}/p"] == 140.5)
    dock.get_by_label("for [s]").fill("0.6")
    workspace.button("tuning", "Run test").click()
    run = dock.locator(".metrics tbody tr").filter(has_text="joint6: p 140.5")
    run.first.wait_for()
    workspace.button("tuning", "Undo").click()
    assert wait_until(lambda: client.gains(name).values == before)
    _nothing_failed(client)
