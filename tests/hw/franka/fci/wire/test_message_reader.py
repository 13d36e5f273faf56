"""Requests come out of a stream as they were sent, however it was cut."""

import pytest

from station.hw.franka.fci.wire.messages import FciProtocolError
from station.hw.franka.fci.wire.robot_protocol import HEADER, Command
from tests.hw.franka.fci.server.robot_client import request


def test_requests_may_arrive_in_pieces_and_together(client):
    data = request(Command.STOP_MOVE, 50) + request(Command.GET_CARTESIAN_LIMIT, 51)
    found = b"".join(client.session.receive(data[i : i + 1]) for i in range(len(data)))
    assert [HEADER.unpack(found[:12])["command_id"]] == [50]
    assert len(found) == 13 + 12 + 154
    assert client.session.receive(data) == found


@pytest.mark.parametrize(
    "head",
    [
        {"command": 14, "size": 12},
        {"command": Command.STOP_MOVE, "size": 11},
        {"command": Command.STOP_MOVE, "size": 13},
        {"command": Command.MOVE, "size": 12},
    ],
)
def test_unknown_commands_and_wrong_sizes_are_protocol_errors(client, head):
    with pytest.raises(FciProtocolError, match="the protocol"):
        client.session.receive(HEADER.pack(head))
