"""The package has its version and `open`, and imports neither robot nor server."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import station

ROOT = Path(__file__).parents[1]


def test_version_is_that_of_the_distribution():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]

    assert station.__version__ == project["version"]


def test_importing_it_imports_nothing_else():
    code = "import sys, station; sys.exit('numpy' in sys.modules)"

    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_other_names_do_not_exist():
    with pytest.raises(AttributeError, match="has no attribute 'close'"):
        _ = station.close


def test_package_says_that_it_is_typed():
    assert (ROOT / "station/py.typed").read_text() == ""
