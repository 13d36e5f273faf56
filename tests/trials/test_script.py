"""The script of a trial is checked when it is read."""

import pytest

from station.trials.errors import ExperimentError
from station.trials.script import parse_script, read_script
from station.wire.excitations import Push, Step

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
