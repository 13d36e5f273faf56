"""The example of ros_control's README runs and is as short as promised."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples/my_robot.py"


def test_the_joints_go_where_they_are_commanded():
    done = subprocess.run(
        [sys.executable, str(EXAMPLE)],
        env={"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
    )

    assert done.stdout == "[0.5, -0.5]\n"


def test_it_has_at_most_thirty_lines():
    lines = [line for line in EXAMPLE.read_text().splitlines() if line.strip()]

    assert len(lines) <= 30
