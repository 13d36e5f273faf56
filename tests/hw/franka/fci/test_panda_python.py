"""Unmodified panda-python, with libfranka 0.9.2 inside, drives the simulated arm.

Each scenario ends where panda-python itself expects it. The client is a process of its
own: panda-python holds the interpreter while it waits for the network. The server waits
for late commands, so that a busy machine changes nothing.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.waiting import PATIENCE

pytest.importorskip("panda_py")
# pylibfranka and franky, of the newest version, are tried in every run.
pytestmark = [pytest.mark.slow, pytest.mark.alone, pytest.mark.long]

CLIENT = Path(__file__).with_name("panda_client.py")
SCENARIOS = (
    "connect",
    "joint_motion",
    "pose_motion",
    "joint_impedance",
    "cartesian_impedance",
    "integrated_velocity",
    "gripper",
    "collision",
)
TABLE = """
scene:
  objects:
    - {name: table, type: table, position: [0.45, 0.0, 0.40], size: [0.4, 0.6, 0.05]}
"""
# A loopback address of this process alone: libfranka's ports are fixed.
HOST = f"127.17.{os.getpid() // 250 % 250}.{os.getpid() % 250 + 1}"


def serve(config):
    """Return the process of a server that clients can connect to."""
    command = [sys.executable, "-m", "station", "fci", str(config), "--host", HOST]
    server = subprocess.Popen(
        [*command, "--patience", "10"], stdout=subprocess.PIPE, text=True
    )
    line = server.stdout.readline()
    assert "Franka Control Interface 5 to 10 of arm 'panda'" in line
    return server


def run_client(*arguments):
    """Run the client to its end."""
    return subprocess.run(
        [sys.executable, str(CLIENT), *arguments],
        capture_output=True,
        text=True,
        timeout=60.0,
        check=False,
    )


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    """What the client saw in each scenario, one after the other."""
    config = tmp_path_factory.mktemp("fci") / "table.yaml"
    config.write_text(TABLE, encoding="utf-8")
    server = serve(config)
    try:
        client = run_client(HOST, *SCENARIOS)
    finally:
        server.terminate()
        left, _ = server.communicate(timeout=PATIENCE)
    assert client.returncode == 0, client.stderr
    assert server.returncode == 0
    assert " 0 commands lost" in left
    return json.loads(client.stdout)


def test_state_and_model_arrive(seen):
    found = seen["connect"]
    assert found["version"] == 5
    assert found["mode"] == "RobotMode.kIdle"
    assert found["q"] == pytest.approx(
        [0, -0.785, 0, -2.356, 0, 1.571, 0.785], abs=1e-3
    )
    assert found["pose"] == pytest.approx(found["pose_of_model"], abs=1e-9)
    assert found["gravity"][3] == pytest.approx(22.02, abs=0.01)


def test_joint_motion_arrives(seen):
    found = seen["joint_motion"]
    assert (found["arrived"], found["back"]) == (True, True)
    assert found["error"] < 0.01  # panda-python's own tolerance


def test_pose_motion_arrives(seen):
    found = seen["pose_motion"]
    assert (found["arrived"], found["back"]) == (True, True)
    assert found["error"] < 0.02  # panda-python's own tolerance


def test_joint_impedance_controller_holds_its_goal(seen):
    assert seen["joint_impedance"]["error"] < 0.01
    assert seen["joint_impedance"]["mode"] == "RobotMode.kIdle"


def test_cartesian_impedance_controller_holds_its_goal(seen):
    assert seen["cartesian_impedance"]["error"] < 0.02


def test_integrated_velocity_controller_follows_what_it_integrates(seen):
    found = seen["integrated_velocity"]
    assert 0.04 < found["turned"] < 0.1
    assert found["error"] < 0.01


def test_gripper_moves_and_grasps_nothing(seen):
    found = seen["gripper"]
    assert found["before"] == pytest.approx(0.08, abs=1e-3)
    assert found["width"] == pytest.approx(0.05, abs=1e-3)
    assert (found["moved"], found["grasped"], found["stopped"]) == (True, False, True)


def test_collision_is_told_in_libfrankas_words_and_recovered_from(seen):
    found = seen["collision"]
    assert found["arrived"] is False
    assert "motion aborted by reflex!" in found["said"]
    assert "cartesian_reflex" in found["errors"]
    assert found["mode"] == "RobotMode.kReflex"
    assert found["recovered"] == "RobotMode.kIdle"
    assert found["back"] is True


OTHER_VERSION = """
import dataclasses, sys
from station.hw.franka.fci.server.fci_server import FciServer, FciSettings
from station.hw.franka.fci.server.robot_session import ClientFeatures
from station.hw.franka.fci.wire.robot_protocol import PANDA
from tests.hw.franka.scripted_arm import ScriptedArm

features = ClientFeatures([dataclasses.replace(PANDA, version=6)])
server = FciServer(ScriptedArm(), None, FciSettings(sys.argv[1]), features)
print("ready", flush=True)
server.run(lambda: False)
"""


def test_client_of_another_version_is_told_both_versions():
    server = subprocess.Popen(
        [sys.executable, "-c", OTHER_VERSION, HOST],
        stdout=subprocess.PIPE,
        text=True,
        cwd=Path(__file__).parents[4],
    )
    try:
        assert server.stdout.readline() == "ready\n"
        code = f"from panda_py import libfranka; libfranka.Robot({HOST!r})"
        client = subprocess.run(
            [sys.executable, "-c", code],
            capture_output=True,
            text=True,
            timeout=60.0,
            check=False,
        )
    finally:
        server.kill()
        server.communicate()
    # Of libfranka's IncompatibleVersionException panda-python keeps both numbers.
    assert "IncompatibleVersionError" in client.stderr
    assert "protocol version 6" in client.stderr
    assert "speaks version 5" in client.stderr
