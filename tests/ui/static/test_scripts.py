"""The page's scripts that need no page, tested by Node's own runner."""

import shutil
import subprocess
from pathlib import Path

import pytest

SCRIPTS = sorted(Path(__file__).parent.glob("*.test.mjs"))
OLDEST = 20
"""The first version of Node whose runner is stable."""


def node_or_skip():
    """Return Node's path; skip the test where it is missing or too old."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is missing: the page's scripts are tested in a browser alone")
    told = subprocess.run([node, "--version"], capture_output=True, text=True)
    if int(told.stdout.lstrip("v").split(".")[0]) < OLDEST:
        pytest.skip(f"node {told.stdout.strip()} has no stable test runner")
    return node


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_a_script_does_what_its_tests_say(script):
    done = subprocess.run(
        [node_or_skip(), "--test", script], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_there_are_such_scripts():
    assert len(SCRIPTS) >= 3
