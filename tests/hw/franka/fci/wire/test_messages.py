"""Answers out of a stream that TCP has cut anywhere."""

import pytest

from station.hw.franka.fci.wire.messages import FciProtocolError, Messages
from station.hw.franka.fci.wire.robot_protocol import (
    HEADER,
    PANDA,
    Command,
    Status,
)


@pytest.fixture
def messages():
    return Messages(PANDA)


def answer(command, number, status, tail=b""):
    body = PANDA.exchanges[command].response.pack({"status": status}) + tail
    head = {"command": command, "command_id": number, "size": HEADER.size + len(body)}
    return HEADER.pack(head) + body


def test_answers_come_out_whole_however_they_are_cut(messages):
    stream = answer(Command.MOVE, 3, 1) + answer(Command.STOP_MOVE, 4, 0)
    found = [one for byte in stream for one in messages.answers(bytes([byte]))]
    assert [(one.command, one.command_id, one.status) for one in found] == [
        (Command.MOVE, 3, Status.MOTION_STARTED),
        (Command.STOP_MOVE, 4, Status.SUCCESS),
    ]


def test_what_follows_the_fields_is_passed_over(messages):
    stream = answer(Command.LOAD_MODEL_LIBRARY, 1, 0, b"library" * 1000)
    found = list(messages.answers(stream + answer(Command.MOVE, 2, 1)))
    assert [one.command_id for one in found] == [1, 2]


@pytest.mark.parametrize("head", [(99, 13), (Command.MOVE, 12)])
def test_what_is_no_answer_is_told(messages, head):
    command, size = head
    data = HEADER.pack({"command": command, "command_id": 1, "size": size})
    with pytest.raises(FciProtocolError, match="libfranka: "):
        list(messages.answers(data + bytes(10)))


def test_status_is_told_in_words(messages):
    stream = answer(Command.MOVE, 1, 1) + answer(Command.STOP_MOVE, 2, 99)
    told = [one.words for one in messages.answers(stream)]
    assert told == ["motion started", "unknown"]
