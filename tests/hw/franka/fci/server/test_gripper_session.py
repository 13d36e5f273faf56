"""The session of a client of the hand, with simulated fingers and a box."""

import pytest

from station.core.description.robot_files import load_robot_files
from station.hw.franka.fci.server.gripper_session import GripperSession
from station.hw.franka.fci.wire.gripper_protocol import (
    GRIPPER_HEADER,
    HAND,
    HandCommand,
)
from station.hw.franka.fci.wire.messages import FciProtocolError
from station.hw.franka.fci.wire.robot_protocol import Status
from station.hw.franka.hand.hand_services import HandServices
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate


class GripperClient:
    """A hand in a world of its own, and what a client asks of it."""

    def __init__(self):
        files = load_robot_files("example-robot-data:panda")
        self.world = simulate([ArmPlacement("panda", files)])
        self.hand = HandServices("panda", self.world.grippers["panda"])
        self.session = GripperSession(self.hand)
        self.ids = 0

    def ask(self, command, **values):
        body = HAND.exchanges[command].request.pack(values)
        self.ids += 1
        head = {"command": command, "command_id": self.ids, "size": 10 + len(body)}
        return self.read(self.session.receive(GRIPPER_HEADER.pack(head) + body))

    def read(self, data):
        """Return (command_id, status) of every answer."""
        found = []
        while data:
            head = GRIPPER_HEADER.unpack(data[:10])
            exchange = HAND.exchanges[HandCommand(head["command"])]
            body, data = data[10 : head["size"]], data[head["size"] :]
            status = exchange.status_of(exchange.response.unpack(body)["status"])
            found.append((head["command_id"], status))
        return found

    def run(self, cycles):
        """Let cycles pass; return the answers that came."""
        found = []
        for _ in range(cycles):
            self.world.arms["panda"].read_once()
            self.hand.advance()
            found += self.read(self.session.after_cycle())
        return found

    def state(self):
        return HAND.state.unpack(self.session.state(5))


@pytest.fixture
def client():
    made = GripperClient()
    assert made.ask(HandCommand.CONNECT, version=3, udp_port=1) == [(1, Status.SUCCESS)]
    return made


def test_state_tells_the_width(client):
    state = client.state()
    assert state["width"] == pytest.approx(0.08, abs=1e-4)
    assert state["max_width"] == pytest.approx(0.08)
    assert (state["is_grasped"], state["message_id"]) == (False, 5)


def test_move_is_answered_when_it_has_arrived(client):
    assert client.ask(HandCommand.MOVE, width=0.06, speed=0.2) == []
    assert client.run(400) == [(2, Status.SUCCESS)]
    assert client.state()["width"] == pytest.approx(0.06, abs=1e-3)


def test_grasp_of_air_is_unsuccessful(client):
    values = {"width": 0.03, "epsilon_inner": 0.005, "epsilon_outer": 0.005}
    assert client.ask(HandCommand.GRASP, speed=0.4, force=20.0, **values) == []
    assert client.run(600) == [(2, Status.UNSUCCESSFUL)]


def test_impossible_width_fails_at_once(client):
    failed = client.ask(HandCommand.MOVE, width=0.2, speed=0.1)
    assert failed == [(2, Status.FAIL)]


def test_stop_aborts_the_motion_that_runs(client):
    client.ask(HandCommand.HOMING)
    client.run(20)
    assert client.ask(HandCommand.STOP) == [
        (2, Status.ABORTED),
        (3, Status.SUCCESS),
    ]
    assert client.run(50) == []


def test_wrong_version_is_not_connected():
    client = GripperClient()
    with pytest.raises(
        FciProtocolError, match="asked for version 2 of the hand"
    ) as caught:
        client.ask(HandCommand.CONNECT, version=2, udp_port=1)
    assert client.read(caught.value.answers) == [
        (1, Status.INCOMPATIBLE_LIBRARY_VERSION)
    ]
    with pytest.raises(FciProtocolError, match="before it had connected"):
        client.ask(HandCommand.HOMING)


def test_client_connects_once(client):
    with pytest.raises(FciProtocolError, match="connected a second time"):
        client.ask(HandCommand.CONNECT, version=3, udp_port=1)


def test_client_that_goes_stops_the_fingers(client):
    client.ask(HandCommand.MOVE, width=0.0, speed=0.05)
    client.run(50)
    client.session.close()
    client.run(200)
    assert client.state()["width"] > 0.06


def test_command_of_somebody_else_aborts_the_clients_and_is_not_taken_for_it(client):
    client.ask(HandCommand.MOVE, width=0.0, speed=0.05)
    client.run(50)
    client.hand.move(0.07, 0.4)
    assert client.run(1) == [(2, Status.ABORTED)]
    client.session.close()  # the fingers belong to somebody else
    client.run(300)
    assert client.state()["width"] == pytest.approx(0.07, abs=1e-3)


def test_client_that_may_not_move_the_fingers_can_stop_them():
    client = GripperClient()
    client.session = GripperSession(client.hand, is_free=lambda: False)
    client.ask(HandCommand.CONNECT, version=3, udp_port=1)
    refused = client.ask(HandCommand.MOVE, width=0.05, speed=0.1)
    assert refused == [(2, Status.FAIL)]
    assert client.ask(HandCommand.STOP) == [(3, Status.SUCCESS)]
