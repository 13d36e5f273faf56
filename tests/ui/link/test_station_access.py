"""Following the station begins before anything heavy is imported."""

import subprocess
import sys

HEAVY = {"viser", "numpy", "uvicorn", "pydantic", "httpx", "yourdfpy", "starlette"}
LIST = "import sys, station.cli.verbs.ui; print('\\n'.join(sys.modules))"


def test_the_verb_that_begins_to_follow_imports_nothing_heavy():
    command = [sys.executable, "-c", LIST]
    found = subprocess.run(command, capture_output=True, text=True, check=True)

    assert "station.ui.link.station_access" in found.stdout
    assert not HEAVY & set(found.stdout.split())
