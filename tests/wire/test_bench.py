"""Requests to the bench on the wire."""

import pytest
from pydantic import ValidationError

from station.wire.excitations import BenchRequest

STEP = {"kind": "step", "joint": "j", "amplitude": 0.1}


def test_an_excitation_is_enough():
    assert BenchRequest.model_validate({"excitation": STEP}).duration == 2.0


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        ({"duration": 11.0}, "duration"),
        ({"excitation": {**STEP, "kind": "push"}}, "excitation"),
        ({"excitation": {**STEP, "kind": "waypoints"}}, "excitation"),
        ({"settling_band": 1.0}, "settling_band"),
    ],
)
def test_what_is_no_measurement_is_refused_with_the_field(wrong, field):
    with pytest.raises(ValidationError, match=field):
        BenchRequest.model_validate({"excitation": STEP, **wrong})
