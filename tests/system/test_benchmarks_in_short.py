"""The benchmarks that also judge: a short run of each finds nothing wrong."""

import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.long

ROOT = Path(__file__).parents[2]


@pytest.mark.alone
@pytest.mark.parametrize(
    ("command", "told"),
    [
        ("bench_arms.py --arms 1 2 --switches 5", "5 switches: nothing wrong"),
        ("pick_and_place.py --poses 1 --seed 1 --factor 4", "1 of 1 succeed"),
        ("robots.py ur3", "1 of 1 start; not good: none"),
    ],
)
def test_a_short_run_finds_nothing_wrong(command, told):
    script, *options = command.split()
    done = subprocess.run(
        [sys.executable, f"benchmarks/{script}", *options],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert told in done.stdout
