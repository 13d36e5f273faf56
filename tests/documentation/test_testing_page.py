"""The examples of the page about testing are tests that pass."""

import os
import re
import subprocess
import sys

import pytest

from tests.documentation.shell_examples import ROOT

DOCS = ROOT / "docs"


def python_blocks(page):
    text = (DOCS / page).read_text()
    return re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


EXAMPLES = python_blocks("testing.md")


@pytest.fixture
def folder(tmp_path):
    """Write down the controller and the robot that the page tests."""
    (tmp_path / "spring.py").write_text(python_blocks("write_a_controller.md")[0])
    (tmp_path / "my_robot_hw.py").write_text(python_blocks("write_a_robot.md")[0])
    return tmp_path


@pytest.mark.long
def test_the_examples_pass(folder):
    names = [f"test_example_{number}" for number in range(len(EXAMPLES))]
    for name, example in zip(names, EXAMPLES, strict=True):
        (folder / f"{name}.py").write_text(example)

    # The plug-ins of these tests take seconds to import.
    others = ("cacheprovider", "schemathesis", "playwright", "xdist", "anyio")
    options = [f"-pno:{name}" for name in others]
    result = subprocess.run(
        [sys.executable, "-mpytest", "-q", "-rA", *options, "."],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(folder), str(ROOT)])},
        capture_output=True,
        text=True,
        check=False,
    )

    assert result.returncode == 0, result.stdout
    passed = set(re.findall(r"^PASSED (\w+)\.py", result.stdout, re.MULTILINE))
    assert passed == set(names), result.stdout


def test_every_example_but_two_is_a_suite():
    assert sum("Conformance" in one or "Recorded" in one for one in EXAMPLES) == 4
    assert len(EXAMPLES) == 6
