"""The names that people write robots and controllers with."""

import subprocess
import sys

import pytest

import station.core


@pytest.mark.parametrize("name", station.core.__all__)
def test_every_name_can_be_imported(name):
    thing = getattr(station.core, name)

    assert thing.__module__.startswith("station.core.")


def test_an_unknown_name_is_refused():
    with pytest.raises(AttributeError, match="no attribute 'Nothing'"):
        station.core.Nothing  # noqa: B018 - asking is the test


def test_asking_for_an_error_does_not_read_the_rest():
    code = (
        "import sys, station.core.errors; "
        "sys.exit('numpy' in sys.modules or 'station.core.station' in sys.modules)"
    )

    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
