"""Users' tests get a station by the fixture of that name."""

import subprocess
import sys

MOCK = """
robot: {type: mock_hw/MockRobotHW, joints: [a]}
controllers:
  group: {type: position_controllers/JointGroupPositionController, joints: [a]}
start: [group]
"""
TESTS = """
import pytest


def test_joint_arrives(station):
    station.command("group", [0.5])
    station.step(2)
    assert station.positions() == {"a": 0.5}


@pytest.mark.station({"robot": {"type": "mock_hw/MockRobotHW", "joints": ["b", "c"]}})
def test_mark_chooses_another(station):
    assert station.joint_names == ["b", "c"]
"""


def test_fixture_opens_the_station_of_the_project(tmp_path):
    (tmp_path / "mock.yaml").write_text(MOCK)
    (tmp_path / "pytest.ini").write_text("[pytest]\nstation_config = mock.yaml\n")
    (tmp_path / "test_mine.py").write_text(TESTS)

    # The plug-ins of these tests take longer to import than the station.
    others = ("schemathesis", "hypothesispytest", "playwright", "xdist", "anyio")
    options = [f"-pno:{name}" for name in others]
    done = subprocess.run(
        [sys.executable, "-mpytest", "-q", "--strict-markers", "-Werror", *options],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )

    assert done.returncode == 0, done.stdout
    assert "2 passed" in done.stdout


def test_plug_in_imports_nothing_of_the_robot():
    code = "import sys, station.pytest_plugin; sys.exit('station.core' in sys.modules)"

    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
