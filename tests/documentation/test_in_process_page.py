"""The examples of docs/in_process.md run as they are printed."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "in_process.md").read_text()
PROGRAM, TEST, ENVIRONMENT = re.findall(r"^```python\n(.*?)^```", PAGE, re.S | re.M)


def run(*arguments: str, folder: Path) -> str:
    command = [sys.executable, "-W", "error", *arguments]
    done = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.slow
def test_program_moves_the_arm(tmp_path):
    time, error = map(float, run("-c", PROGRAM, folder=tmp_path).split())

    assert time > 2.0
    assert 0.05 < error < 0.2


@pytest.mark.slow
def test_test_passes(tmp_path):
    (tmp_path / "test_mine.py").write_text(TEST)

    assert "1 passed" in run("-m", "pytest", "-q", folder=tmp_path)


@pytest.mark.slow
def test_environment_is_stepped(tmp_path):
    code = ENVIRONMENT + "print(round(info['time'], 6))\n"

    assert run("-c", code, folder=tmp_path) == "2.0\n"
