"""The memory between a control thread and the process that serves its clients."""

import pytest

from station.hw.franka.fci.server.shared_page import PAGE_BYTES, SharedPage
from station.hw.franka.fci.wire.robot_protocol import PANDA


@pytest.fixture
def sides():
    """Return the page as the control thread sees it, and as the server sees it."""
    memory = bytearray(PAGE_BYTES)
    return SharedPage(memory), SharedPage(memory)


def test_empty_page_has_nothing(sides):
    control, server = sides
    assert control.take_command() is None
    assert server.take_state() is None
    assert server.take_answers() == b""
    assert control.put_answers(b"")


def test_newest_state_is_taken_once(sides):
    control, server = sides
    for value in range(5):
        control.put_state(bytearray([value] * PANDA.state.size))
    taken = server.take_state()
    assert bytes(taken) == bytes([4] * PANDA.state.size)
    assert server.take_state() is None


def test_state_that_is_overwritten_while_it_is_copied_is_not_taken(sides, monkeypatch):
    control, server = sides
    size, copy = PANDA.state.size, SharedPage._find
    control.put_state(bytearray([1] * size))
    coming = [bytearray([2] * size), bytearray([3] * size)]

    def interrupted(self, kind, number):
        data = copy(self, kind, number)
        while coming:
            control.put_state(coming.pop(0))
        return data

    monkeypatch.setattr(SharedPage, "_find", interrupted)
    assert server.take_state() == bytes([3] * size)
    assert server.take_state() is None


def test_newest_command_is_taken_once_and_others_are_no_commands(sides):
    control, server = sides
    size = PANDA.command.size
    server.put_command(bytes([1] * size))
    server.put_command(bytes([2] * size))
    server.put_command(b"noise")
    assert control.take_command() == bytes([2] * size)
    assert control.take_command() is None


def test_answers_wait_for_room(sides):
    control, server = sides
    assert control.put_answers(b"first")
    assert not control.put_answers(b"second")
    assert server.take_answers() == b"first"
    assert server.take_answers() == b""
    assert control.put_answers(b"second")
