"""Excitations on the wire: what they refuse, and that they say which field."""

import pytest
from pydantic import TypeAdapter, ValidationError

from station.wire.excitations import Command, Push, Sine, Step

COMMAND = TypeAdapter(Command)


def test_kind_decides_which_excitation_it_is():
    sine = {"kind": "sine", "joint": "j", "amplitude": 0.1, "frequency": 2}
    push = {"kind": "push", "link": "l", "at": 0, "lasts": 1, "force": [0, 1, 0]}

    assert COMMAND.validate_python(sine) == Sine(joint="j", amplitude=0.1, frequency=2)
    assert COMMAND.validate_python(push) == Push(
        link="l", at=0, lasts=1, force=(0.0, 1.0, 0.0)
    )


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        ({"kind": "sine", "joint": "j", "amplitude": 1.0, "frequency": 0}, "frequency"),
        ({"kind": "step", "joint": "j", "amplitude": "1"}, "amplitude"),
        ({"kind": "step", "joint": "j", "amplitude": 1.0, "until": 1}, "until"),
        (
            {"kind": "waypoints", "joint": "j", "times": [1, 1], "values": [0, 1]},
            "increase",
        ),
        ({"kind": "recorded", "joint": "j", "times": [1], "values": [0, 1]}, "values"),
    ],
)
def test_what_is_no_excitation_is_refused_with_the_field(wrong, field):
    with pytest.raises(ValidationError, match=field):
        COMMAND.validate_python(wrong)


def test_the_kind_is_sent_though_nobody_has_written_it():
    """A client sends only what was set, and the station needs the kind."""
    sent = Step(joint="j", amplitude=0.1).model_dump(exclude_unset=True)

    assert COMMAND.validate_python(sent) == Step(joint="j", amplitude=0.1)
