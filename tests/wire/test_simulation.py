"""Wire models of a simulated robot's time."""

import pytest
from pydantic import ValidationError

from station.wire import ResetRequest, SimulationPatch, StepRequest


def test_what_is_left_out_changes_nothing():
    assert SimulationPatch().model_dump() == {"paused": None, "real_time_factor": None}
    assert StepRequest().n == 1
    assert ResetRequest().joint_positions == {}


@pytest.mark.parametrize("position", [float("nan"), float("inf"), "0.5", None, True])
def test_positions_are_numbers(position):
    with pytest.raises(ValidationError):
        ResetRequest.model_validate({"joint_positions": {"j": position}})
