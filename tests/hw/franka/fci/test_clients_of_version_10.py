"""Unmodified pylibfranka and franky, which ask for version 10, drive a simulated FR3.

The ends of their motions are judged by Pinocchio from the joints. Each client is a
process of its own; the server waits for late commands, so that a busy machine changes
nothing.
"""

import json
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from station.core.description.robot_files import load_robot_files
from station.hw.franka.arm.arm_description import load_arm_description
from station.hw.franka.arm.arm_limits import FR3_LIMITS
from station.hw.franka.fci.server.robot_model import write_robot_model
from tests.hw.franka.fci.clients_of_version_10 import ASIDE, TURN
from tests.waiting import PATIENCE

# Both register the same C++ types, so that one process can import only one of them.
_MISSING = [name for name in ("pylibfranka", "franky") if find_spec(name) is None]
pytestmark = [
    pytest.mark.slow,
    pytest.mark.alone,
    pytest.mark.skipif(bool(_MISSING), reason=f"not installed: {_MISSING}"),
]

CLIENT = Path(__file__).with_name("clients_of_version_10.py")
# A loopback address of this process alone: libfranka's ports are fixed.
HOST = f"127.18.{os.getpid() // 250 % 250}.{os.getpid() % 250 + 1}"


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    """What each client saw in each scenario, one client after the other."""
    config = tmp_path_factory.mktemp("fci") / "fr3.yaml"
    config.write_text("robot: {arm: fr3}\n", encoding="utf-8")
    command = [sys.executable, "-m", "station", "fci", str(config), "--host", HOST]
    server = subprocess.Popen(
        [*command, "--patience", "10"], stdout=subprocess.PIPE, text=True
    )
    found = {}
    try:
        assert "5 to 10 of arm 'fr3'" in server.stdout.readline()
        for name in ("pylibfranka", "franky"):
            client = subprocess.run(
                [sys.executable, str(CLIENT), HOST, name],
                capture_output=True,
                text=True,
                timeout=90.0,
                check=False,
            )
            assert client.returncode == 0, client.stderr
            found[name] = json.loads(client.stdout)
    finally:
        server.terminate()
        left, _ = server.communicate(timeout=PATIENCE)
    assert " 0 commands lost" in left
    return found


@pytest.fixture(scope="module")
def model():
    """Pinocchio's model of the arm."""
    description = load_arm_description("example-robot-data:panda", FR3_LIMITS)
    assert load_robot_files("example-robot-data:panda").xml != description.xml
    return pin.buildModelFromXML(write_robot_model(description, FR3_LIMITS, "fr3"))


def way_of_flange(model, motion):
    """Return how far a motion moved the flange [m], and turned it [rad]."""
    poses = []
    for key in ("begin", "end"):
        data = model.createData()
        pin.framesForwardKinematics(model, data, np.array(motion[key]))
        poses.append(data.oMf[model.getFrameId("link8")])
    begin, end = poses
    turned = pin.log3(begin.rotation.T @ end.rotation)
    return (end.translation - begin.translation).tolist(), float(np.abs(turned).max())


def test_pylibfranka_gets_the_model_of_the_arm(seen, model):
    found = seen["pylibfranka"]["connect"]
    q = np.array(found["q"])
    assert found["q"][3] == pytest.approx(-2.356, abs=1e-3)
    # The state adds the hand, 0.73 kg, to the URDF's last link.
    bare = pin.computeGeneralizedGravity(model, model.createData(), q)
    assert abs(found["gravity"][0]) < 1e-6
    assert 2.0 < abs(found["gravity"][3] - bare[3]) < 6.0


@pytest.mark.parametrize(
    ("motion", "way"),
    [
        ("positions", [0, 0, 0, 0.2, 0, -0.2, 0]),
        ("velocities", [0, 0, 0, -0.2, 0, 0, 0]),
        ("torques", [0.0] * 7),
    ],
)
def test_pylibfranka_moves_the_joints(seen, motion, way):
    found = seen["pylibfranka"][motion]
    assert (found["within"], found["mode"]) == ("Move", "Idle")
    moved = np.array(found["end"]) - found["begin"]
    # A joint without torques of friction stands within 3 mrad of its goal.
    assert moved.tolist() == pytest.approx(way, abs=3e-3)


@pytest.mark.parametrize(("motion", "height"), [("pose", -0.05), ("twist", 0.05)])
def test_pylibfranka_moves_the_hand(seen, model, motion, height):
    moved, turned = way_of_flange(model, seen["pylibfranka"][motion])
    assert moved == pytest.approx([0.0, 0.0, height], abs=1.5e-3)
    assert turned < 5e-3


def test_pylibfranka_gives_a_target_and_waits_for_the_plan_to_reach_it(seen):
    found = seen["pylibfranka"]["asynchronous"]
    assert found["status"] == "kTargetReached"
    # The client asks q_d whether the plan is there; the joints are 4 mrad behind.
    assert found["end"] == pytest.approx(ASIDE, abs=6e-3)


def test_pylibfranka_is_told_of_a_jump_and_recovers_at_the_first_attempt(seen):
    found = seen["pylibfranka"]["jump"]
    name = "joint_position_motion_generator_start_pose_invalid"
    assert f'motion aborted by reflex! ["{name}"]' in found["said"]
    assert (found["before"], found["after"]) == ("Reflex", "Idle")


def test_franky_reaches_its_joints_and_waypoints(seen):
    assert seen["franky"]["joint"]["end"] == pytest.approx(ASIDE, abs=3e-3)
    found = seen["franky"]["waypoints"]
    assert found["end"] == pytest.approx(found["begin"], abs=3e-3)


def test_franky_moves_the_hand_and_stops_by_a_reaction(seen, model):
    moved, turned = way_of_flange(model, seen["franky"]["cartesian"])
    # The hand's own axis points down: its 5 cm are 5 cm towards the floor.
    assert np.linalg.norm(moved) == pytest.approx(0.05, abs=1.5e-3)
    assert turned < 5e-3
    moved, _ = way_of_flange(model, seen["franky"]["reaction"])
    assert 0.005 < np.linalg.norm(moved) < 0.15


@pytest.mark.parametrize(
    ("motion", "way", "within"),
    # The second one is a spring of franky's own, of 1500 N/m and 80 Nm/rad.
    [("cartesian waypoints", 0.0640, 1.5e-3), ("cartesian impedance", 0.03, 5e-3)],
)
def test_franky_leads_the_hand(seen, model, motion, way, within):
    moved, turned = way_of_flange(model, seen["franky"][motion])
    assert np.linalg.norm(moved) == pytest.approx(way, abs=within)
    assert turned < 5e-3


@pytest.mark.parametrize(("motion", "sign"), [("joint impedance", 1), ("torques", -1)])
def test_franky_s_own_springs_turn_the_joints(seen, motion, sign):
    found = seen["franky"][motion]
    moved = sign * np.subtract(found["end"], found["begin"])
    # Friction holds a joint where a soft spring no longer moves it.
    assert moved == pytest.approx(TURN, abs=0.03)


def test_franky_moves_the_hand_s_fingers(seen):
    assert seen["franky"]["hand"]["moved"] is True
    assert seen["franky"]["hand"]["width"] == pytest.approx(0.04, abs=2e-3)
