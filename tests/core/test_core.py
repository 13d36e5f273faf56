"""The names that people write robots and controllers with."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import station.core
from station.core import public
from tests.for_each import for_each

PAGE = Path(__file__).parents[2] / "docs" / "python.md"


@for_each("name", station.core.__all__)
def test_every_name_can_be_imported(name):
    thing = getattr(station.core, name)

    assert thing.__module__.startswith("station.core.")


def test_an_unknown_name_is_refused():
    with pytest.raises(AttributeError, match="no attribute 'Nothing'"):
        station.core.Nothing  # noqa: B018 - asking is the test


def test_asking_for_an_error_does_not_read_the_rest():
    code = (
        "import sys, station.core.errors; "
        "sys.exit(not {'numpy', 'station.core.facade.station'}.isdisjoint(sys.modules))"
    )

    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_everything_that_is_imported_is_exported():
    imported = {name for name, value in vars(public).items() if callable(value)}

    assert imported == set(public.__all__)


def test_the_page_about_python_lists_exactly_the_public_names():
    lines = PAGE.read_text().splitlines()
    rows = [line for line in lines if line.startswith(("- ", "  "))]
    listed = re.findall(r"`(\w+)`", "\n".join(rows))

    assert sorted(listed) == sorted(public.__all__)
