"""A wheel carries a kernel that is found; without a compiler it carries none."""

import os
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

from station.kernel.toolchain import missing_tool
from tests.system.station_process import ROOT

NO_COMPILER = {"PATH": "/nonexistent", "CC": ""}
SHOW_KERNEL = "import station.kernel as k; print(k.STATUS.mode, k.functions.__file__)"


def build(source, target, into, **environment):
    """Build a distribution without network; return its file."""
    command = [sys.executable, "-m", "hatchling", "build", "-t", target, "-d", into]
    result = subprocess.run(
        command,
        cwd=source,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stderr
    (built,) = into.glob("*.whl" if target == "wheel" else "*.tar.gz")
    return built


def run_unpacked(wheel, folder):
    """Import the kernel of an unpacked wheel, which lies before every other station."""
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
    environment = {k: v for k, v in os.environ.items() if k != "STATION_COMPILED"}
    result = subprocess.run(
        [sys.executable, "-c", f"import station.kernel.functions; {SHOW_KERNEL}"],
        cwd=folder,
        env={
            **environment,
            **NO_COMPILER,
            "XDG_CACHE_HOME": str(folder / "cache"),
            "PYTHONPATH": str(folder),
        },
        capture_output=True,
        text=True,
        check=True,
    )
    mode, file = result.stdout.split()
    return mode, Path(file)


@pytest.mark.skipif(missing_tool() is not None, reason=str(missing_tool()))
def test_a_wheel_carries_a_kernel_that_runs(tmp_path):
    wheel = build(ROOT, "wheel", tmp_path / "dist", STATION_WHEEL_KERNEL="1")
    folder = tmp_path / "installed"

    mode, file = run_unpacked(wheel, folder)

    assert mode == "compiled"
    assert file.is_relative_to(folder / "station" / "kernel" / "compiled")
    version = f"cp{sys.version_info.major}{sys.version_info.minor}"
    assert f"-{version}-{version}" in wheel.name


def test_the_sdist_becomes_a_wheel_without_a_compiler(tmp_path):
    sdist = build(ROOT, "sdist", tmp_path / "sdist", **NO_COMPILER)
    with tarfile.open(sdist) as archive:
        archive.extractall(tmp_path, filter="data")
    source = tmp_path / sdist.name.removesuffix(".tar.gz")

    wheel = build(source, "wheel", tmp_path / "dist", **NO_COMPILER)

    assert wheel.name.endswith("-py3-none-any.whl")
    with zipfile.ZipFile(wheel) as archive:
        assert not [name for name in archive.namelist() if "/compiled/" in name]


def test_a_wheel_that_must_carry_a_kernel_is_not_built_without_a_compiler(tmp_path):
    with pytest.raises(AssertionError, match="No C compiler was found"):
        build(ROOT, "wheel", tmp_path, STATION_WHEEL_KERNEL="1", **NO_COMPILER)
