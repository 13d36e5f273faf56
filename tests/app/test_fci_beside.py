"""Programs of libfranka beside the controllers of a station, with its real process."""

import importlib.util
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from station.api.app import create_app
from station.api.auth import Authenticator
from station.app.composition import compose
from station.app.fci_beside import FciBeside
from station.app.fci_run import FciRobotError
from station.app.restart_limit import MOST_RESTARTS
from station.client import StationClient
from station.config import load_config
from station.core.control.switching import SwitchRequest
from station.core.errors import ArmCommandError, LoopError, SwitchRefusedError
from station.core.franka import RobotMode
from station.core.loop.stop_latch import StopState
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.fci.desk.desk_state import Desk
from station.hw.franka.fci.driver.fci_arm import FciArm
from station.hw.franka.fci.driver.network import FciNetwork, FciNetworkError
from station.hw.franka.fci.server.client_port import FciPortError
from station.hw.franka.fci.wire.robot_protocol import PANDA
from station.wire import GripperMoveRequest
from tests.api.conftest import AppTransport
from tests.hw.franka.fci.server.test_client_services import hand_of
from tests.hw.franka.plain_model import PlainModel
from tests.waiting import wait_until

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
LONGEST_CHANGE = 30.0
"""Longest wait for a change that Desk asks for [s]."""
JOINTS = ControllerMode.JOINT_IMPEDANCE
LONGEST = 100_000
"""Requests within which the fingers have arrived."""
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

    # A cycle that begins late is not made up for while the client owes commands.
    cycle, longest = station.loop.control_cycle, []
    for _ in range(200):
        arm.command_joint_positions(list(arm.state.q_d))
        arm.read_once()
        longest.append(cycle.longest_period)
    assert station.loop.period in longest


def test_arm_whose_server_was_started_anew_is_connected_again(tmp_path):
    built = station_of(CONFIG, tmp_path)
    built.loop.start()

    def connect():
        return FciNetwork(HOST, PANDA.port)

    with FciBeside(built, HOST, pytest.fail):
        arm = FciArm(connect(), PlainModel, is_enforced=False, reopen=connect)
    for _ in range(LONGEST):
        if arm.is_lost():
            break
        arm.wait()
    assert arm.failure() == "libfranka: UDP receive: Timeout"
    assert recovered(arm) is RobotMode.OTHER
    assert "Connection to FCI refused" in arm.failure()

    with FciBeside(built, HOST, pytest.fail):
        assert recovered(arm) is RobotMode.IDLE
        before = arm.read_once().time
        assert arm.read_once().time > before
        arm.close()
    built.loop.stop()


def recovered(arm):
    """Recover an arm as a control thread does; return the mode at the end."""
    arm.automatic_error_recovery()
    for _ in range(LONGEST):
        arm.wait()
        arm.read_once()
        if arm.state.robot_mode is not RobotMode.AUTOMATIC_ERROR_RECOVERY:
            break
    return arm.state.robot_mode


def test_desk_beside_the_controllers_opens_brakes_and_never_the_stop(tmp_path):
    built = station_of(CONFIG, tmp_path)
    built.loop.start()
    arm, motion = built.loop.hw.arm, (JOINTS, MotionGeneratorMode.JOINT_POSITION)
    with FciBeside(built, HOST, pytest.fail) as beside:
        desk = Desk(beside, arm, None, "panda")
        assert (desk.are_brakes_closed, desk.is_fci_active) == (False, True)
        built.switch_controllers(SwitchRequest(start=["holder"]))
        built.stop("test")
        desk.set_brakes(closed=True).result(LONGEST_CHANGE)
        assert arm.state.robot_mode is RobotMode.OTHER
        desk.set_brakes(closed=False).result(LONGEST_CHANGE)
        assert arm.state.robot_mode is RobotMode.IDLE
        assert built.loop.stop_latch.state is StopState.STOPPED
        client = FciArm(FciNetwork(HOST, PANDA.port), PlainModel, is_enforced=False)
        with pytest.raises(ArmCommandError, match="command not possible in the curr"):
            client.start_motion(*motion)

        desk.set_fci(active=False).result(LONGEST_CHANGE)
        with pytest.raises(FciNetworkError, match="refused"):
            FciNetwork(HOST, PANDA.port)
        desk.set_fci(active=True).result(LONGEST_CHANGE)
        FciNetwork(HOST, PANDA.port).close()
        client.close()
    built.loop.stop()


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


def test_process_that_dies_is_told_and_replaced_unless_it_dies_too_often(tmp_path):
    def is_served():
        try:
            FciNetwork(HOST, PANDA.port).close()
        except FciNetworkError:
            return False
        return True

    def kill_it():
        command = ["pgrep", "-P", str(os.getpid()), "-f", "fci_process"]
        found = subprocess.run(command, capture_output=True, text=True, check=True)
        os.kill(int(found.stdout), signal.SIGKILL)

    built, warned = station_of(CONFIG, tmp_path), []
    built.loop.start()
    with FciBeside(built, HOST, warned.append):
        for count in range(MOST_RESTARTS):
            kill_it()
            assert wait_until(lambda n=count: len(warned) > n)
            assert "another begins" in warned[count]
            assert wait_until(is_served)
        kill_it()
        assert wait_until(lambda: len(warned) > MOST_RESTARTS)
        assert "too often" in warned[-1]
        assert not is_served()
    built.loop.stop()


def test_no_process_is_left_beside_a_station_whose_loop_has_died(tmp_path, monkeypatch):
    def refuse(_action):
        raise LoopError("The loop has died.")

    built, warned = station_of(CONFIG, tmp_path), []
    monkeypatch.setattr(built.loop, "run_in_cycle", refuse)
    with pytest.raises(LoopError):
        FciBeside(built, HOST, warned.append)
    with pytest.raises(FciNetworkError, match="refused"):
        FciNetwork(HOST, PANDA.port)


def test_robot_without_this_interface_is_refused(tmp_path):
    with pytest.raises(FciRobotError, match=r"fci\.enabled is true") as error:
        FciBeside(station_of(MOCK, tmp_path), HOST, pytest.fail)
    assert "fci.enabled to false" in error.value.remedy


def test_hand_of_one_station_is_the_real_hand_of_another(station, tmp_path):
    other = station_of(
        CONFIG.replace("  realism", f"  robot_ip: {HOST}\n  realism"), tmp_path
    )
    other.loop.start()
    app = create_app(other, Authenticator("operator-token", "viewer-token"))
    url = "http://127.0.0.1:8000"
    with StationClient(url, "operator-token", transport=AppTransport(app)) as client:
        gripper = client.robot("panda").gripper
        begun = gripper.move(GripperMoveRequest(width=0.05, speed=0.2))
        assert begun.activity == "moving"
        for _ in range(LONGEST):
            state = gripper.state()
            if state.command is None:
                break
            other.loop.run_in_cycle(lambda: None)
    other.loop.stop()
    other.loop.hw.close()
    assert (state.last.status, state.last.message) == ("succeeded", "")
    there = hand_of(station.loop.hw).get_state()
    assert there.width == pytest.approx(0.05, abs=2e-3)


@pytest.mark.skipif(
    importlib.util.find_spec("panda_py") is None, reason="panda-python is not installed"
)
@pytest.mark.usefixtures("station")
def test_panda_python_connects_and_moves_the_hand_beside_the_loop():
    done = subprocess.run(
        [sys.executable, str(CLIENT), HOST, "connect", "gripper"],
        capture_output=True,
        text=True,
        timeout=60.0,
        check=True,
    )
    seen = json.loads(done.stdout)
    arm, hand = seen["connect"], seen["gripper"]
    assert arm["version"] == 5
    assert arm["pose_of_model"] == pytest.approx(arm["pose"], abs=1e-9)
    assert (hand["moved"], hand["grasped"], hand["stopped"]) == (True, False, True)
    assert hand["width"] == pytest.approx(0.05, abs=1e-3)
