"""A station starts with, without and beside a kernel, and says which one runs."""

import shutil
import signal
import subprocess
import sys
import sysconfig
import time
from pathlib import Path

import pytest

from station.client import StationClient
from station.kernel.built import fitting_kernel
from station.kernel.manifest import (
    Manifest,
    find_damage,
    fingerprint,
    module_file,
    read_manifest,
    target,
)
from station.kernel.toolchain import missing_tool
from tests.system.station_process import ROOT, StationProcess

needs_compiler = pytest.mark.skipif(
    missing_tool() is not None, reason=str(missing_tool())
)
BUILD_PATIENCE = 400.0
"""How long a build in idle time may take on a machine with other work [s]."""
COMPILED_ANEW = module_file("functions")
"""The only module that is not taken over from another kernel: compiled in seconds."""
NO_COMPILER = {"PATH": "/nonexistent", "CC": ""}


class Environment:
    """A virtual environment without a kernel, with the packages of the present one.

    Args:
        folder: Where it is made.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        command = [sys.executable, "-m", "venv", "--without-pip", folder / "venv"]
        subprocess.run(command, check=True)
        self.python = folder / "venv" / "bin" / "python"
        venv = folder / "venv"
        packages = sysconfig.get_path("purelib", vars={"base": str(venv)})
        paths = f"{ROOT}\n{sysconfig.get_path('purelib')}\n"
        (Path(packages) / "station.pth").write_text(paths)
        self.kernels = venv / "share" / "control-station" / "kernel"
        self._stations: list[StationProcess] = []

    def start(self, **environment: str) -> StationProcess:
        """Start a station in this environment."""
        runtime = self._folder / f"run{len(self._stations)}"
        runtime.mkdir()
        station = StationProcess(
            runtime,
            "--no-ui",
            python=self.python,
            environment={"XDG_CACHE_HOME": str(self._folder / "cache"), **environment},
        )
        self._stations.append(station)
        return station

    def keep_modules(self) -> None:
        """Put a kernel of other sources into the cache, with all modules but one.

        A build from nothing, which takes minutes, is what the tests' own kernel has
        been through.
        """
        sound = fitting_kernel()
        if sound is None:
            return
        earlier = self._folder / "cache" / "control-station" / "kernel" / "earlier"
        shutil.copytree(sound, earlier)
        (earlier / COMPILED_ANEW).unlink()
        kept = read_manifest(sound)
        Manifest("other sources", target(), kept.modules, kept.recipes).write(earlier)

    def wait_for_kernel(self) -> Path:
        """Wait until a sound kernel is there."""
        deadline = time.monotonic() + BUILD_PATIENCE
        directory = self.kernels / fingerprint()
        while not directory.is_dir() or find_damage(directory) is not None:
            assert time.monotonic() < deadline, "no kernel is built"
            time.sleep(0.1)
        return directory

    def clean_up(self) -> None:
        """End whatever is left of the stations."""
        for station in self._stations:
            station.clean_up()


@pytest.fixture
def environment(tmp_path):
    """Return an environment without a kernel."""
    environment = Environment(tmp_path)
    yield environment
    environment.clean_up()


def kernel_of(station):
    """Return what a station says of its kernel: at its start, and in its status."""
    access = station.access()
    with StationClient(access["url"], access["token"]) as client:
        status = client.status().kernel
    return station.told(0)["kernel"], f"{status.mode}: {status.reason}"


def doctor(station):
    """Return what the doctor says of the kernel in a station's environment."""
    lines = station.command("doctor").stdout.splitlines()
    return next(line for line in lines if line.startswith("kernel"))


def test_without_a_compiler_it_runs_interpreted_and_says_so(environment):
    station = environment.start(**NO_COMPILER)

    told, status = kernel_of(station)

    assert told.startswith("interpreted: There is no compiled kernel. No C compiler")
    assert status == told
    assert "interpreted" in doctor(station)
    assert not environment.kernels.exists()
    assert station.end(signal.SIGINT) < 5.0


@needs_compiler
def test_with_a_compiler_the_next_start_runs_what_the_first_had_built(environment):
    environment.keep_modules()
    first = environment.start()
    assert kernel_of(first)[0].startswith("interpreted: A compiled kernel is being ")
    first.end(signal.SIGINT)
    environment.wait_for_kernel()

    second = environment.start()

    told, status = kernel_of(second)
    assert told.startswith("compiled: It was built from these sources")
    assert status == told
    assert "compiled" in doctor(second)


@needs_compiler
def test_a_stale_kernel_is_not_loaded_and_another_one_is_built(environment):
    environment.keep_modules()
    stale = environment.kernels / "0123456789abcdef"
    stale.mkdir(parents=True)
    Manifest("other sources", target(), {}).write(stale)

    station = environment.start()

    told, status = kernel_of(station)
    assert told.startswith("interpreted: A compiled kernel is being built")
    assert status.startswith("interpreted")
    assert environment.wait_for_kernel() != stale


def test_a_stale_kernel_is_told_where_there_is_no_compiler(environment):
    stale = environment.kernels / "0123456789abcdef"
    stale.mkdir(parents=True)
    Manifest("other sources", target(), {}).write(stale)

    told, _ = kernel_of(environment.start(**NO_COMPILER))

    assert f"{stale} is stale: it was built from other sources." in told


@pytest.mark.skipif(fitting_kernel() is None, reason="no kernel to damage")
def test_a_damaged_kernel_is_not_loaded(environment):
    sound = fitting_kernel()
    directory = environment.kernels / sound.name
    shutil.copytree(sound, directory)
    library = directory / module_file("functions")
    library.write_bytes(library.read_bytes()[:5000])

    told, _ = kernel_of(environment.start(**NO_COMPILER))
    assert "is damaged: functions" in told
