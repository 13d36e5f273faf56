"""A client beside the controllers of a station: one of them commands the arm."""

import pytest

from station.core.errors import ArmCommandError, SwitchRefusedError
from station.core.franka import GripperServicesInterface, RobotMode
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.fci.driver.fci_arm import FciArm
from station.hw.franka.fci.server.client_services import (
    ArmClientService,
    HandClientService,
    with_client_services,
)
from station.hw.franka.fci.server.robot_session import ClientFeatures
from station.hw.franka.fci.server.shared_page import PAGE_BYTES, SharedPage
from station.hw.franka.fci.wire.gripper_protocol import (
    GRIPPER_HEADER,
    HAND,
    HandCommand,
)
from station.hw.franka.fci.wire.robot_protocol import Status
from tests.hw.franka.plain_model import PlainModel
from tests.hw.franka.test_franka_hw import PERIOD, controllers, make, switch

JOINT = ControllerMode.JOINT_IMPEDANCE
POSITION = MotionGeneratorMode.JOINT_POSITION


class BesideNetwork:
    """Joins the driver, as a client, to the service of a station; all in one thread.

    A wait for a state is a cycle of the station.
    """

    udp_port = 4711

    def __init__(self):
        memory = bytearray(PAGE_BYTES)
        self.hw, self.page, self.may_move = make(), SharedPage(memory), True
        self.now = 0.0
        self.service = self.hw.client_service = ArmClientService(
            self.hw.arm,
            SharedPage(memory),
            ClientFeatures(),
            is_commanded=lambda: self.hw.is_commanded,
            may_move=lambda: self.may_move,
            now=lambda: self.now,
        )
        self.waits = []
        self.read = with_client_services(self.service, self.hw.read, self.waits.append)
        self._answers = bytearray()
        self.service.open()

    def send(self, data):
        self._answers += self.service.receive(data)[0]

    def receive(self, timeout):
        data = bytes(self._answers) + self.page.take_answers()
        self._answers.clear()
        return data

    def send_datagram(self, data):
        self.page.put_command(bytes(data))

    def cycle(self, passed=PERIOD):
        """Run a cycle of the station some time after the last one."""
        self.now += passed
        self.read(0.0, PERIOD)
        self.hw.write(0.0, PERIOD)

    def wait(self, buffer):
        self.cycle()
        state = self.page.take_state()
        if state is None:
            return 0
        buffer[: len(state)] = state
        return len(state)

    def poll(self, buffer):
        return 0

    def close(self):
        self.service.leave()


@pytest.fixture
def network():
    return BesideNetwork()


@pytest.fixture
def client(network):
    return FciArm(network, PlainModel, is_enforced=False)


def move(client, cycles=50):
    """Turn joint 1 with a growing velocity."""
    for cycle in range(cycles):
        q = list(client.state.q_d)
        q[0] += 1e-7 * cycle
        client.command_joint_positions(q)
        client.read_once()


def test_client_moves_an_arm_that_no_controller_commands(network, client):
    before = network.hw.robot_state.q_d[0]
    client.start_motion(JOINT, POSITION)
    move(client)
    assert client.state.robot_mode is RobotMode.MOVE
    assert network.hw.robot_state.q_d[0] == pytest.approx(before + 1e-7 * 49 * 25)
    client.stop_motion()
    client.read_once()
    assert client.state.robot_mode is RobotMode.IDLE
    assert not client.failure()


def test_arm_waits_for_a_late_loop_while_a_client_owes_commands(network, client):
    client.start_motion(JOINT, POSITION)
    client.read_once()
    assert not any(network.waits)  # the first command may come whenever it does
    move(client)
    assert network.waits[-1]
    client.stop_motion()
    client.read_once()
    assert not network.waits[-1]


def test_arm_waits_once_if_a_client_had_no_time_to_answer(network, client):
    client.start_motion(JOINT, POSITION)
    move(client)
    before = network.hw.robot_state.time
    network.cycle(0.3 * PERIOD)
    assert network.hw.robot_state.time == before
    network.cycle(0.1 * PERIOD)
    assert network.hw.robot_state.time == pytest.approx(before + PERIOD)
    network.cycle(0.6 * PERIOD)
    assert network.hw.robot_state.time == pytest.approx(before + 2 * PERIOD)


def test_answer_in_a_short_cycle_is_carried_out_at_once(network, client):
    client.start_motion(JOINT, POSITION)
    move(client)
    q, before = list(client.state.q_d), network.hw.robot_state.time
    q[0] += 5e-6
    client.command_joint_positions(q)
    network.now -= 0.8 * PERIOD
    client.read_once()
    assert network.hw.robot_state.time == pytest.approx(before + PERIOD)
    assert network.hw.robot_state.q_d[0] == pytest.approx(q[0])


def test_switch_is_refused_while_a_client_moves(network, client):
    client.start_motion(JOINT, POSITION)
    move(client)
    with pytest.raises(SwitchRefusedError, match="client of the Franka") as refused:
        network.hw.prepare_switch(controllers("jp"), [])
    assert "end its motion" in refused.value.remedy
    move(client)
    assert client.state.robot_mode is RobotMode.MOVE

    client.stop_motion()
    client.read_once()
    network.hw.prepare_switch(controllers("jp"), [])


def test_motion_is_refused_while_controllers_run(network, client):
    switch(network.hw, "jp")
    client.read_once()
    words = r'Move command rejected: command not possible in the current mode \("Move"'
    with pytest.raises(ArmCommandError, match=words):
        client.start_motion(JOINT, POSITION)
    assert network.hw.mode() == "move"

    switch(network.hw, "none", "jp")
    client.read_once()
    client.start_motion(JOINT, POSITION)


def test_setting_is_refused_while_controllers_run(network, client):
    switch(network.hw, "jp")
    client.read_once()
    with pytest.raises(ArmCommandError, match="Set Joint Impedance command rejected"):
        client.set_joint_impedance([1000.0] * 7)


def test_state_is_read_beside_controllers(network, client):
    switch(network.hw, "jp")
    for _ in range(5):
        before = client.state.time
        client.read_once()
        assert client.state.time == pytest.approx(before + PERIOD)
    assert client.state.q == network.hw.robot_state.q


def test_stop_of_the_station_ends_the_clients_motion(network, client):
    client.start_motion(JOINT, POSITION)
    move(client)
    network.may_move = False
    client.read_once()
    client.read_once()
    assert network.hw.mode() == "idle"
    assert client.failure() == "libfranka: Move command preempted!"
    with pytest.raises(ArmCommandError, match="command not possible"):
        client.start_motion(JOINT, POSITION)
    network.may_move = True
    client.start_motion(JOINT, POSITION)


def test_switch_that_began_before_the_clients_motion_takes_the_arm_over(
    network, client
):
    network.hw.prepare_switch(controllers("jp"), [])
    client.start_motion(JOINT, POSITION)
    move(client)
    network.hw.do_switch(controllers("jp"), [])
    client.read_once()
    client.read_once()
    assert network.hw.mode() == "move"
    assert client.failure() == "libfranka: Move command preempted!"
    assert not network.service.is_moving


def test_client_that_goes_leaves_the_arm_holding(network, client):
    client.start_motion(JOINT, POSITION)
    move(client)
    network.close()
    network.hw.read(0.0, PERIOD)
    assert network.hw.mode() == "idle"
    assert not network.service.is_moving
    network.service.open()  # the next one
    assert FciArm(network, PlainModel).state.robot_mode is RobotMode.IDLE


def hand_of(hw):
    """Return the hand of a robot."""
    return hw.get(GripperServicesInterface).get_handle("panda")


def ask(service, command, **values):
    """Send a request to a hand; return the answers that come at once."""
    body = HAND.exchanges[command].request.pack(values)
    head = {"command": command, "command_id": 7, "size": 10 + len(body)}
    return statuses(command, service.receive(GRIPPER_HEADER.pack(head) + body)[0])


def statuses(command, data):
    """Return the statuses of answers to the same command."""
    response = HAND.exchanges[command].response
    step = GRIPPER_HEADER.size + response.size
    parts = [data[i + 10 : i + step] for i in range(0, len(data), step)]
    exchange = HAND.exchanges[command]
    return [exchange.status_of(response.unpack(part)["status"]) for part in parts]


@pytest.fixture
def hand(network):
    """A client of the hand, served beside the one of the arm."""
    memory = bytearray(PAGE_BYTES)
    service = HandClientService(
        hand_of(network.hw),
        SharedPage(memory),
        may_move=lambda: network.may_move,
    )
    network.read = with_client_services(network.service, network.hw.read, bool, service)
    service.open()
    assert ask(service, HandCommand.CONNECT, version=3, udp_port=1) == [Status.SUCCESS]
    return service, SharedPage(memory)


def test_client_moves_the_hand_beside_the_controllers(network, client, hand):
    service, page = hand
    switch(network.hw, "jp")
    assert ask(service, HandCommand.MOVE, width=0.06, speed=0.4) == []
    answers, states = b"", 0
    for _ in range(300):
        client.read_once()
        answers += page.take_answers()
        state = page.take_state()
        states += state is not None
        width = HAND.state.unpack(state)["width"] if state is not None else 0.0
    assert statuses(HandCommand.MOVE, answers) == [Status.SUCCESS]
    assert states == 30
    assert width == pytest.approx(0.06, abs=1e-3)


def test_hand_of_a_stopped_station_is_refused(network, client, hand):
    service, page = hand
    ask(service, HandCommand.MOVE, width=0.0, speed=0.05)
    network.may_move = False
    hand_of(network.hw).interrupt("The station was stopped.")
    client.read_once()
    aborted = statuses(HandCommand.MOVE, page.take_answers())
    assert aborted == [Status.ABORTED]
    fail = [Status.FAIL]
    assert ask(service, HandCommand.MOVE, width=0.05, speed=0.1) == fail


def test_client_of_the_hand_that_goes_stops_its_motion(network, client, hand):
    service, page = hand
    ask(service, HandCommand.MOVE, width=0.0, speed=0.05)
    client.read_once()
    service.leave()
    assert hand_of(network.hw).get_state().command is None
    client.read_once()
    assert page.take_answers() == b""
