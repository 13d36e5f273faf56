"""Wire models of a simulation and its scene."""

import pytest
from pydantic import ValidationError

from station.reports import examples_of
from station.wire import ResetRequest, SceneObject, SimulationPatch, StepRequest


def test_what_is_left_out_changes_nothing():
    assert SimulationPatch().model_dump() == {"paused": None, "real_time_factor": None}
    assert StepRequest().n == 1
    assert ResetRequest().joint_positions == {}


@pytest.mark.parametrize("position", [float("nan"), float("inf"), "0.5", None, True])
def test_positions_are_numbers(position):
    with pytest.raises(ValidationError):
        ResetRequest.model_validate({"joint_positions": {"j": position}})


def test_the_example_is_valid():
    (example,) = examples_of(SceneObject.__doc__)

    assert SceneObject.model_validate(example).name == "cube"
