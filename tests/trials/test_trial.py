"""A trial is data that its hash names.

The script of a trial is checked when it is read.
"""

import pytest

from station.trials.errors import ExperimentError, ImpossibleRangeError
from station.trials.trial import Setup, Trial, TrialResult, parse_script, read_script
from station.wire.excitations import Push, Step


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
    # A station loads a controller of any name of letters, digits and underscores.
    more = setup.with_controllers({"6_axes": other})
    assert more.config().controller_parameters()["6_axes"] == other
    assert more.digest != setup.digest


SCRIPT = """
controller: arm
duration: 2.0
commands:
  - {kind: step, joint: a, amplitude: 0.3, at: 0.1}
  - {kind: push, link: tool, at: 1.5, lasts: 0.1, force: [0, 10, 0]}
"""


def test_file_of_a_script_is_read(tmp_path):
    file = tmp_path / "script.yaml"
    file.write_text(SCRIPT)

    script = read_script(file)

    assert script.motions == (Step(joint="a", amplitude=0.3, at=0.1),)
    assert [type(push) for push in script.pushes] == [Push]


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"duration": 0}, "duration: Input should be greater than 0 (given: 0)"),
        ({"controller": None}, "controller: Input should be a valid string"),
        ({"commands": [{"kind": "jump"}]}, "does not match any of the expected tags"),
        (
            {"commands": [{"kind": "sine", "joint": "a", "amplitude": 1}]},
            "commands.0.sine.frequency: Field required",
        ),
        (
            {
                "commands": [
                    {
                        "kind": "waypoints",
                        "joint": "a",
                        "times": [2, 1],
                        "values": [0, 0],
                    }
                ]
            },
            "times must increase",
        ),
        (
            {
                "commands": [
                    {
                        "kind": "recorded",
                        "joint": "a",
                        "times": [1, 1],
                        "values": [0, 0],
                    }
                ]
            },
            "times must increase",
        ),
        ({"wait": 1}, "wait: Extra inputs are not permitted"),
    ],
)
def test_impossible_script_is_refused_by_name(change, reason):
    with pytest.raises(ExperimentError) as caught:
        parse_script({"controller": "arm", "duration": 1.0, **change})

    assert reason in caught.value.message


def test_missing_file_is_refused_by_name(tmp_path):
    with pytest.raises(ExperimentError, match=r"nothing\.yaml: The file cannot"):
        read_script(tmp_path / "nothing.yaml")
