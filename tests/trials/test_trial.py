"""A trial is data that its hash names."""

import pytest

from station.trials.errors import ImpossibleRangeError
from station.trials.setup import Setup
from station.trials.trial import Trial, TrialResult


def test_hash_names_everything_that_the_trial_consists_of(step):
    slower = Setup.load(settings={"station.rate": 500})

    hashes = {
        step.hash,
        step.with_parameters({"load": 1.0}).hash,
        step.with_parameters({}, seed=1).hash,
        Trial(slower, step.script).hash,
        Trial(step.setup, step.script.model_copy(update={"duration": 0.2})).hash,
    }

    assert len(hashes) == 5
    assert Trial.from_json(step.setup, step.to_json()).hash == step.hash


def test_what_serves_is_no_part_of_a_setup(panda):
    asked = {"api.port": 1234, "api.token": "a-secret-token"}
    served = Setup.load(settings={**asked, "robot.realism": "ideal"})

    assert served == panda
    assert "token" not in panda.text
    assert panda.config().start == ["joint_state_controller"]


@pytest.mark.parametrize(
    ("parameters", "seed", "reason"),
    [({"load": float("nan")}, 0, "'load' is nan"), ({}, -1, "seed is -1")],
)
def test_impossible_trial_is_refused(step, parameters, seed, reason):
    with pytest.raises(ImpossibleRangeError, match=reason):
        step.with_parameters(parameters, seed)


def test_result_describes_itself():
    done = TrialResult("ab", "done", None, {"energy": 1.5}, 0.1, "here:1")
    failed = TrialResult("ab", "failed", "It fell.", {}, 0.1, "here:1")

    assert done.describe() == "ab done: energy 1.5"
    assert failed.describe() == "ab failed: 'It fell.'"


def test_setup_with_controllers_that_are_loaded_already_is_the_same():
    """An infinite parameter is one that the text of a setup has as null."""
    name = "effort_group_position_controller"
    setup = Setup.load(settings={f"controllers.{name}.farthest": float("inf")})
    parameters = setup.config().controller_parameters()
    parameters[name]["farthest"] = float("inf")
    other = {"type": "effort_controllers/JointGroupPositionController", "joints": []}

    assert setup.with_controllers(parameters) == setup
    more = setup.with_controllers({"other": other})
    assert more.config().controller_parameters()["other"] == other
    assert more.digest != setup.digest
