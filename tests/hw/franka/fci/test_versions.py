"""The versions of the FR3: the driver and the server's session speak each of them."""

import pytest

from station.core.errors import ArmCommandError, InvalidCommandError
from station.core.franka import RobotMode
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.fci.driver.fci_arm import FciArm
from station.hw.franka.fci.driver.fci_client import IncompatibleVersionError
from station.hw.franka.fci.server.robot_session import ClientFeatures, RobotSession
from station.hw.franka.fci.wire.messages import FciProtocolError
from station.hw.franka.fci.wire.robot_protocol import (
    FR3,
    HEADER,
    PANDA,
    PROTOCOLS,
    Command,
    MoveController,
    MoveGenerator,
    Status,
)
from tests.hw.franka.fci.stepped_network import SteppedNetwork
from tests.hw.franka.plain_model import PlainModel
from tests.hw.franka.scripted_arm import ScriptedArm

JOINTS = ControllerMode.JOINT_IMPEDANCE, MotionGeneratorMode.JOINT_POSITION
TORQUES = ControllerMode.EXTERNAL_CONTROLLER, MotionGeneratorMode.NONE


@pytest.fixture(params=FR3, ids=lambda p: f"version {p.version}")
def network(request):
    return SteppedNetwork(ScriptedArm(), request.param)


@pytest.fixture
def arm(network):
    protocol = network.session._protocol
    return FciArm(network, PlainModel, is_enforced=False, protocol=protocol)


def test_motions_settings_and_recovery(network, arm):
    arm.start_motion(*JOINTS)
    arm.command_joint_positions([0.1] * 7)
    arm.read_once()
    assert network.arm.sent == [[0.1] * 7]
    arm.stop_motion()
    assert arm.state.robot_mode is RobotMode.IDLE

    arm.start_motion(*TORQUES)
    arm.command_joint_torques([0.5] * 7)
    arm.read_once()
    network.arm.fail("joint_reflex")
    arm.read_once()
    assert arm.failure() == "libfranka: Move command aborted: motion aborted by reflex!"
    arm.automatic_error_recovery()
    arm.read_once()
    arm.read_once()
    assert arm.state.robot_mode is RobotMode.IDLE

    arm.set_joint_impedance([1000.0] * 7)
    arm.set_end_effector_frame(arm.state.NE_T_EE)


def test_refusals_of_safety_functions_are_told_in_libfrankas_words(
    monkeypatch, network, arm
):
    exchange = network.session._protocol.exchanges[Command.MOVE]
    head = {"command": exchange.number, "command_id": 2, "size": HEADER.size + 1}
    answer = HEADER.pack(head) + exchange.response.pack({"status": 4})
    monkeypatch.setattr(network.session, "receive", lambda _data: answer)
    with pytest.raises(ArmCommandError, match="due to activated safety function!"):
        arm.start_motion(*JOINTS)


def test_setting_that_the_version_refuses_is_told(monkeypatch, network, arm):
    def refuse(_stiffness):
        raise InvalidCommandError("No.")

    monkeypatch.setattr(network.arm, "set_joint_impedance", refuse)
    with pytest.raises(InvalidCommandError, match="invalid argument!"):
        arm.set_joint_impedance([1000.0] * 7)


class Client:
    """A client that speaks one version to a session that speaks several."""

    def __init__(self, version, protocols=FR3):
        self.arm = ScriptedArm()
        self.session = RobotSession(self.arm, ClientFeatures(protocols))
        self.protocol = PROTOCOLS[version]

    def ask(self, command, **values):
        """Return the numbers of the statuses of what is answered at once."""
        exchange = self.protocol.exchanges[command]
        body = exchange.request.pack(values)
        head = {"command": exchange.number, "command_id": 9, "size": 12 + len(body)}
        return self.read(self.session.receive(HEADER.pack(head) + body))

    def read(self, data):
        """Return (number of the command, number of the status) of every answer."""
        found = []
        while data:
            head = HEADER.unpack(data[:12])
            found.append((head["command"], data[12]))
            data = data[head["size"] :]
        return found


@pytest.mark.parametrize("version", [6, 7, 8, 9, 10])
def test_client_chooses_one_of_the_versions_that_are_spoken(version):
    client = Client(version)
    assert client.ask(Command.CONNECT, version=version, udp_port=1) == [(0, 0)]
    assert client.ask(Command.STOP_MOVE) == [(2, 0)]
    assert client.ask(Command.SET_LOAD, m_load=0.1) == [(9, 0)]


def test_client_of_the_panda_is_told_that_an_fr3_is_no_panda():
    client = Client(5)
    with pytest.raises(FciProtocolError) as refused:
        client.ask(Command.CONNECT, version=5, udp_port=1)
    assert client.read(refused.value.answers) == [(0, 1)]
    network = SteppedNetwork(ScriptedArm(), FR3[0])
    with pytest.raises(IncompatibleVersionError, match=r"server version: 6, libr.*: 5"):
        FciArm(network, PlainModel, protocol=PANDA)


def test_version_7_moves_without_a_generator_until_the_torques_end():
    client = Client(7)
    client.ask(Command.CONNECT, version=7, udp_port=1)
    modes = {
        "controller_mode": MoveController.EXTERNAL_CONTROLLER,
        "motion_generator_mode": MoveGenerator.NONE,
    }
    assert client.ask(Command.MOVE, **modes) == [(1, 1)]
    state = client.protocol.state.unpack(client.session.state(1))
    assert state["motion_generator_mode"] == 5
    for number, is_over in ((1, False), (2, True)):
        command = {"message_id": number, "torque_command_finished": is_over}
        client.session.receive_command(client.protocol.command.pack(command))
        assert client.session.before_cycle() == b""
        client.arm.read_once()
        answers = client.read(client.session.after_cycle())
    assert answers == [(1, 0)]
    assert client.arm.state.robot_mode is RobotMode.IDLE


def test_version_6_has_no_motion_without_a_generator():
    client = Client(6)
    client.ask(Command.CONNECT, version=6, udp_port=1)
    modes = {"controller_mode": 2, "motion_generator_mode": MoveGenerator.NONE}
    refused = client.protocol.exchanges[Command.MOVE].statuses.index(
        Status.INVALID_ARGUMENT_REJECTED
    )
    assert client.ask(Command.MOVE, **modes) == [(1, refused)]
