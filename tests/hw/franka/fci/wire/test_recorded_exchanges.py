"""What the public headers' own structures hold is read, and written to the same bytes.

`record_exchanges.cpp` has written the files with the headers of each version.
"""

import struct
from pathlib import Path

import pytest

from station.hw.franka.fci.wire.messages import Messages, Request
from station.hw.franka.fci.wire.robot_protocol import (
    PROTOCOLS,
    Command,
    Status,
)

FOLDER = Path(__file__).parent
MOVE = {
    "controller_mode": 2,
    "motion_generator_mode": 3,
    "maximum_path_deviation": (1.0, 2.0, 3.0),
    "maximum_goal_pose_deviation": (4.0, 5.0, 6.0),
    "use_async_motion_generator": True,
    "maximum_velocity": (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0),
}
# Values that are no numbers made of the field's name.
GIVEN = {
    "message_id": 4711,
    "motion_generator_mode": 4,
    "controller_mode": 2,
    "robot_mode": 4,
}
REQUESTS = {
    Command.CONNECT: {"udp_port": 5000},
    Command.MOVE: MOVE,
    Command.GET_CARTESIAN_LIMIT: {"id": 3},
    Command.LOAD_MODEL_LIBRARY: {"architecture": 3, "system": 1},
}
STATUSES = {
    Command.CONNECT: [Status.INCOMPATIBLE_LIBRARY_VERSION],
    Command.MOVE: [Status.MOTION_STARTED, Status.ABORTED],
    Command.STOP_MOVE: [Status.ABORTED],
    Command.GET_CARTESIAN_LIMIT: [Status.SUCCESS],
    Command.AUTOMATIC_ERROR_RECOVERY: [Status.ABORTED],
    Command.LOAD_MODEL_LIBRARY: [Status.SUCCESS],
    Command.GET_ROBOT_MODEL: [Status.SUCCESS],
}
TAILS = {Command.LOAD_MODEL_LIBRARY: b"\x7fELF", Command.GET_ROBOT_MODEL: b"<robot/>"}


@pytest.fixture(params=PROTOCOLS.values(), ids=lambda one: f"version {one.version}")
def protocol(request):
    return request.param


@pytest.fixture
def parts(protocol):
    """Return requests, answers, state and command."""
    data = (FOLDER / f"exchanges_of_version_{protocol.version}.bin").read_bytes()
    sizes, start, found = struct.unpack_from("<4I", data), 16, []
    for size in sizes:
        found.append(data[start : start + size])
        start += size
    assert start == len(data)
    return found


def numbers(layout, name):
    """Return the numbers that the recorder has given a field."""
    code = sum((i + 1) * ord(letter) for i, letter in enumerate(name)) % 4096
    return [code + i / 32 for i in range(layout.counts[name])]


def check(layout, values, given):
    for name, value in values.items():
        if name in given:
            assert value == given[name], name
            continue
        found = list(value) if isinstance(value, tuple) else [value]
        wanted = numbers(layout, name)
        if isinstance(found[0], bool):
            wanted = [int(number * 32) % 3 == 0 for number in wanted]
        assert found == wanted, name


def test_state_and_command_are_those_of_the_headers(protocol, parts):
    for layout, data in ((protocol.state, parts[2]), (protocol.command, parts[3])):
        values = layout.unpack(data)
        check(layout, values, GIVEN)
        assert layout.pack(values) == data


def test_requests_are_read_and_written_to_the_same_bytes(protocol, parts):
    messages = Messages(protocol)
    found = list(messages.requests(parts[0]))
    assert [one.command for one in found] == list(protocol.exchanges)
    assert [one.command_id for one in found] == list(range(1, len(found) + 1))
    for one in found:
        given = {"version": protocol.version, **REQUESTS.get(one.command, {})}
        check(protocol.exchanges[one.command].request, one.values, given)
    written = (
        messages.request(one.command, one.command_id, one.values) for one in found
    )
    assert b"".join(written) == parts[0]


def test_answers_are_read_and_written_to_the_same_bytes(protocol, parts):
    messages = Messages(protocol)
    found, written = list(messages.answers(parts[1])), b""
    for one in found:
        layout = protocol.exchanges[one.command].response
        given = {"version": protocol.version, "status": one.values["status"]}
        check(layout, one.values, given)
        assert one.rest == TAILS.get(one.command, b"")
        request = Request(one.command, one.command_id, {})
        written += messages.answer(request, one.status, one.values, tail=one.rest)
    assert written == parts[1]
    told = [(one.command, one.status) for one in found]
    wrong = [Status.INVALID_ARGUMENT_REJECTED]
    assert told == [
        (command, status)
        for command in protocol.exchanges
        for status in STATUSES.get(command, wrong)
    ]
