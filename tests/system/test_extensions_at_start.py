"""A station starts with, without and beside its extensions, and says what runs."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from station.client import StationClient
from station.compiled import find_misfit, missing_tool, record_path
from tests.system.checkout import copy_checkout
from tests.system.station_process import StationProcess
from tests.waiting import wait_until

pytestmark = pytest.mark.long

needs_extensions = pytest.mark.skipif(
    find_misfit() is not None, reason=str(find_misfit())
)
BUILD_PATIENCE = 400.0
"""How long a build in idle time may take on a machine with other work [s]."""
NO_COMPILER = {"PATH": "/nonexistent", "CC": ""}
IS_COMPILED = (
    "from station.compiled import find_misfit; raise SystemExit(find_misfit())"
)


class Checkout:
    """A checkout of its own, in which stations start.

    Args:
        folder: Where it is made.
        keep_extensions: Whether it has the extensions of this one.
    """

    def __init__(self, folder: Path, *, keep_extensions: bool) -> None:
        self._folder = folder
        self.root = copy_checkout(folder / "checkout", keep_extensions=keep_extensions)
        self._stations: list[StationProcess] = []

    def extensions(self) -> list[Path]:
        """Return the files that Python would import in place of sources."""
        return sorted((self.root / "station").rglob("*.so"))

    def start(self, **environment: str) -> StationProcess:
        """Start a station of this checkout."""
        runtime = self._folder / f"run{len(self._stations)}"
        runtime.mkdir()
        station = StationProcess(
            runtime, "--no-ui", root=self.root, environment=environment
        )
        self._stations.append(station)
        return station

    def wait_for_extensions(self) -> None:
        """Wait until a build has left its record, and extensions that fit."""
        record, before = record_path(self.root / "station"), record_path().read_text()

        def is_new():
            return record.exists() and record.read_text() != before

        assert wait_until(is_new, BUILD_PATIENCE, pause=0.5)
        # Another process asks, once: one for each look takes the time that is left over
        # by others, in which the build runs.
        command = [sys.executable, "-c", IS_COMPILED]
        assert subprocess.run(command, cwd=self.root, check=False).returncode == 0

    def clean_up(self) -> None:
        """End whatever is left of the stations."""
        for station in self._stations:
            station.clean_up()


@pytest.fixture
def checkout(tmp_path):
    """Return a checkout with its extensions."""
    checkout = Checkout(tmp_path, keep_extensions=True)
    yield checkout
    checkout.clean_up()


@pytest.fixture
def bare_checkout(tmp_path):
    """Return a checkout without extensions."""
    checkout = Checkout(tmp_path, keep_extensions=False)
    yield checkout
    checkout.clean_up()


def said_by(station):
    """Return what a station says of its extensions: at its start, and in its status."""
    access = station.access()
    with StationClient(access["url"], access["token"]) as client:
        status = client.status().kernel
    return station.told(0)["kernel"], f"{status.mode}: {status.reason}"


def doctor(station):
    """Return what the doctor says of them in a station's checkout."""
    lines = station.command("doctor").stdout.splitlines()
    return next(line for line in lines if line.startswith("control cycle"))


def test_without_a_compiler_it_runs_interpreted_and_says_so(bare_checkout):
    station = bare_checkout.start(**NO_COMPILER)

    told, status = said_by(station)

    assert told.startswith(
        "interpreted: There are no compiled extensions. No C compiler"
    )
    assert status == told
    assert "interpreted" in doctor(station)
    assert bare_checkout.extensions() == []
    assert station.end(signal.SIGINT) < 5.0


@needs_extensions
@pytest.mark.skipif(missing_tool() is not None, reason=str(missing_tool()))
def test_stale_extensions_do_not_run_and_the_next_start_has_new_ones(checkout):
    with (checkout.root / "station" / "memory" / "functions.py").open("a") as source:
        source.write("# edited\n")
    first = checkout.start()
    told, status = said_by(first)
    assert told == status
    assert told.startswith("interpreted: Compiled extensions are being built")
    first.end(signal.SIGINT)
    checkout.wait_for_extensions()

    second = checkout.start()

    told, status = said_by(second)
    assert told.startswith("compiled: It was built from these sources")
    assert status == told
    assert "compiled" in doctor(second)


@needs_extensions
def test_a_damaged_extension_is_not_loaded(checkout):
    damaged = next(e for e in checkout.extensions() if e.name.startswith("functions."))
    damaged.write_bytes(damaged.read_bytes()[:5000])

    told, _ = said_by(checkout.start(**NO_COMPILER))

    assert "functions" in told
    assert "is missing or damaged." in told
