"""The scorecard on the command line."""

import json
from pathlib import Path

import pytest

from station.cli import main

ROOT = Path(__file__).parents[3]


def test_validate_writes_a_page_and_fails_when_a_check_does(capsys, tmp_path):
    config, page = tmp_path / "robot.yaml", tmp_path / "card.html"
    config.write_text(
        "controllers: {lost: {type: position_controllers/JointGroupPositionController, "
        "joints: [elbow]}}\nstart: []\n"
    )

    assert main(["validate", str(config), "--page", str(page)]) == 1
    assert "controller lost loads" in capsys.readouterr().out
    assert "<h1>Scorecard of robot.yaml</h1>" in page.read_text()


def test_validate_takes_a_urdf(capsys):
    urdf = ROOT / "examples" / "robots" / "differential_wrist.urdf"

    main(["validate", str(urdf), "--json"])

    checks = {c["name"]: c["outcome"] for c in json.loads(capsys.readouterr().out)}
    assert checks["robot loads"] == "passed"
    assert checks["controller joint_trajectory_controller loads"] == "passed"


@pytest.mark.slow
def test_validate_takes_a_robot_by_name_as_run_does(capsys):
    code = main(["validate", "example-robot-data:so101", "--json"])

    checks = {c["name"]: c["outcome"] for c in json.loads(capsys.readouterr().out)}
    assert checks["controller position_group_controller loads"] == "passed"
    assert code == 0


def test_validate_of_an_unknown_robot_says_which_there_are(capsys):
    assert main(["validate", "example-robot-data:nobody"]) != 0
    assert "no robot 'nobody'" in capsys.readouterr().err
