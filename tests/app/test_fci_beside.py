"""Programs of libfranka beside the controllers of a station, with its real process."""

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from station.app.composition import compose
from station.app.fci_beside import FciBeside
from station.app.fci_run import FciRobotError
from station.config import load_config
from station.core.control.switching import SwitchRequest
from station.core.errors import ArmCommandError, SwitchRefusedError
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.fci.driver.fci_arm import FciArm
from station.hw.franka.fci.driver.network import FciNetwork, FciNetworkError
from station.hw.franka.fci.server.client_port import FciPortError
from station.hw.franka.fci.wire.robot_protocol import PANDA
from tests.hw.franka.plain_model import PlainModel

pytestmark = [pytest.mark.slow, pytest.mark.alone]

CLIENT = Path(__file__).parents[1] / "hw/franka/fci/panda_client.py"
# A loopback address of this process alone: libfranka's ports are fixed.
HOST = f"127.19.{os.getpid() // 250 % 250}.{os.getpid() % 250 + 1}"
CONFIG = """
robot:
  type: franka_hw/FrankaHW
  arm_id: panda
  robot_description: example-robot-data:panda
  realism: ideal
  realtime_config: ignore
controllers:
  holder:
    type: position_controllers/JointGroupPositionController
    joints: [panda_joint1, panda_joint2, panda_joint3, panda_joint4, panda_joint5,
      panda_joint6, panda_joint7]
start: []
"""
MOCK = "robot: {type: mock_hw/MockRobotHW, joints: [a]}\ncontrollers: {}\nstart: []\n"


def station_of(text, tmp_path):
    path = tmp_path / "station.yaml"
    path.write_text(text, encoding="utf-8")
    return compose(load_config(path)).station


@pytest.fixture
def station(tmp_path):
    """A station whose loop runs, with a process for clients beside it."""
    built = station_of(CONFIG, tmp_path)
    built.loop.start()
    with FciBeside(built, HOST, pytest.fail):
        yield built
    built.loop.stop()


@pytest.fixture
def arm(station):
    """A client that has connected to the station."""
    del station
    connected = FciArm(FciNetwork(HOST, PANDA.port), PlainModel, is_enforced=False)
    yield connected
    connected.close()


def test_client_and_controllers_take_turns(station, arm):
    motion = ControllerMode.JOINT_IMPEDANCE, MotionGeneratorMode.JOINT_POSITION
    station.switch_controllers(SwitchRequest(start=["holder"]))
    arm.read_once()
    with pytest.raises(ArmCommandError, match="command not possible in the current"):
        arm.start_motion(*motion)

    station.switch_controllers(SwitchRequest(stop=["holder"]))
    before = arm.read_once().time
    arm.start_motion(*motion)
    with pytest.raises(SwitchRefusedError, match="client of the Franka Control") as no:
        station.switch_controllers(SwitchRequest(start=["holder"]))
    assert "end its motion" in no.value.remedy
    assert arm.read_once().time > before


def test_second_station_at_the_same_address_is_told(station, tmp_path):
    del station
    other = station_of(CONFIG, tmp_path)
    with pytest.raises(FciPortError, match=HOST) as error:
        FciBeside(other, HOST, pytest.fail)
    assert "fci.host" in error.value.remedy


def test_port_is_free_when_the_station_has_ended(tmp_path):
    built = station_of(CONFIG, tmp_path)
    with FciBeside(built, HOST, pytest.fail):
        pass
    with pytest.raises(FciNetworkError, match="refused"):
        FciNetwork(HOST, PANDA.port)


def test_robot_without_this_interface_is_refused(tmp_path):
    with pytest.raises(FciRobotError, match=r"fci\.enabled is true") as error:
        FciBeside(station_of(MOCK, tmp_path), HOST, pytest.fail)
    assert "fci.enabled to false" in error.value.remedy


@pytest.mark.skipif(
    importlib.util.find_spec("panda_py") is None, reason="panda-python is not installed"
)
@pytest.mark.usefixtures("station")
def test_panda_python_connects_beside_the_loop():
    done = subprocess.run(
        [sys.executable, str(CLIENT), HOST, "connect"],
        capture_output=True,
        text=True,
        timeout=60.0,
        check=True,
    )
    seen = json.loads(done.stdout)["connect"]
    assert seen["version"] == 5
    assert seen["pose_of_model"] == pytest.approx(seen["pose"], abs=1e-9)
