"""The tables of the hand's protocol, against sizes counted in the public header."""

from hypothesis import given

from station.hw.franka.fci.wire.gripper_protocol import (
    GRIPPER_HEADER,
    HAND,
    HandCommand,
)
from tests.hw.franka.fci.wire.drawn_values import values_of


def test_gripper_has_its_sizes():
    sizes = {c: HAND.exchanges[c].request.size for c in HandCommand}
    assert list(sizes.values()) == [4, 0, 40, 16, 0]
    assert HAND.exchanges[HandCommand.CONNECT].response.size == 4
    assert HAND.state.size == 23
    assert (GRIPPER_HEADER.size, HAND.port, HAND.version) == (10, 1338, 3)


@given(values_of(HAND.state))
def test_a_state_of_the_hand_comes_back_as_it_went(values):
    assert HAND.state.unpack(HAND.state.pack(values)) == values
