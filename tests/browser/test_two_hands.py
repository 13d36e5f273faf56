"""The hands of two arms: each is moved for itself, and has settings of its own."""

import xml.etree.ElementTree as ET

import pytest
import yaml

from station.client import StationClient
from tests.browser.conftest import run_station
from tests.browser.workspace_page import wait_until

pytestmark = pytest.mark.long

ARMS = ("panda_1", "panda_2")
KINDS = ("CartesianJogController", "CartesianStreamingController")


def _joints(arm):
    return [f"{arm}_joint{i}" for i in range(1, 8)]


def _config():
    """Return two arms that take Cartesian motions, each in a world of its own."""
    arms = {
        arm: {
            "type": "franka_hw/FrankaHW",
            "arm_id": arm,
            "robot_description": "example-robot-data:panda",
            "realtime_config": "ignore",
        }
        for arm in ARMS
    }
    kind = "combined_robot_hw/CombinedRobotHW"
    return {
        "robot": {"type": kind, "robot_hardware": list(ARMS), **arms},
        "controllers": {
            "states": {
                "type": "joint_state_controller/JointStateController",
                "publish_rate": 50,
            }
        },
        "start": ["states"],
    }


def _of_both(description):
    """Return a description of both arms, from that of the first arm."""
    both = ET.Element("robot", name="both")
    ET.SubElement(both, "link", name="world")
    for arm in ARMS:
        both.extend(ET.fromstring(description.replace(ARMS[0], arm)))
        joint = ET.SubElement(both, "joint", name=f"{arm}_stand", type="fixed")
        ET.SubElement(joint, "parent", link="world")
        ET.SubElement(joint, "child", link=f"{arm}_link0")
    return ET.tostring(both, encoding="unicode")


@pytest.fixture(scope="module")
def running_station(tmp_path_factory):
    """A station with two arms, and a controller of each kind for each hand."""
    home = tmp_path_factory.mktemp("station")
    path = home / "two_hands.yaml"
    path.write_text(yaml.safe_dump(_config()))
    with run_station(home, str(path)) as running:
        with StationClient(running.api, running.token) as client:
            first = client.parameter("robot_description")
            client.set_parameter("robot_description", _of_both(first))
            for arm in ARMS:
                for kind in KINDS:
                    params = {"arm_id": arm, "joint_names": _joints(arm)}
                    kind_name = f"franka_controllers/{kind}"
                    client.load_controller(f"{arm}_{kind}", kind_name, params)
        yield running


def _hand(client, arm):
    """Return where the hand of an arm is, in the base of the arm [m]."""
    return client.robot(arm).state().O_T_EE[12:15]


def _choose(workspace, arm):
    """Choose an arm in the dock, with its hand unfolded."""
    dock = workspace.dock("move")
    dock.get_by_label("Arm", exact=True).select_option(arm)
    if not dock.get_by_role("button", name="Here", exact=True).is_visible():
        dock.get_by_text("Hand: jog and target").click()
    return dock


def _running(client):
    return {c.name for c in client.controllers() if c.state == "running"} - {"states"}


@pytest.mark.parametrize("arm", ARMS)
def test_the_hand_of_the_chosen_arm_is_jogged(workspace, client, arm):
    other = ARMS[1 - ARMS.index(arm)]
    dock = _choose(workspace, arm)
    dock.get_by_role("button", name="Start hand jog").click()
    assert wait_until(lambda: f"{arm}_{KINDS[0]}" in _running(client))
    dock.get_by_text(f"{arm}_{KINDS[0]} moves the hand in the axes of the").wait_for()
    up = dock.get_by_role("button", name="Move the hand along z while held", exact=True)
    before, still = _hand(client, arm)[2], _hand(client, other)[2]
    up.hover()
    workspace.page.mouse.down()
    assert wait_until(lambda: _hand(client, arm)[2] > before + 0.015)
    workspace.page.mouse.up()
    assert abs(_hand(client, other)[2] - still) < 1e-3


@pytest.mark.parametrize("arm", ARMS)
def test_the_hand_of_the_chosen_arm_goes_to_a_typed_place(workspace, client, arm):
    other = ARMS[1 - ARMS.index(arm)]
    dock = _choose(workspace, arm)
    dock.get_by_role("button", name="Start hand targets").click()
    assert wait_until(lambda: f"{arm}_{KINDS[1]}" in _running(client))
    dock.get_by_text(f"{arm}_{KINDS[1]} moves the hand to a pose").wait_for()
    here, still = _hand(client, arm), _hand(client, other)[1]
    dock.get_by_role("button", name="Here", exact=True).click()
    shown = dock.get_by_label("Hand x [m]").input_value()
    assert float(shown) == pytest.approx(here[0], abs=2e-3)
    workspace.type_into("move", "Hand y [m]", f"{here[1] + 0.05:.3f}")
    assert wait_until(lambda: _hand(client, arm)[1] > here[1] + 0.04)
    assert abs(_hand(client, other)[1] - still) < 1e-3
