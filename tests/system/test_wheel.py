"""A wheel carries extensions that run; without a compiler it carries none."""

import os
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

from station.compiled import find_misfit
from tests.system.checkout import compile_only, copy_checkout

pytestmark = pytest.mark.long

NO_COMPILER = {"PATH": "/nonexistent", "CC": "", "STATION_COMPILED": ""}
SHOW = (
    "from station import compiled; from station.memory import functions; "
    "print(compiled.status().mode, functions.__file__)"
)
BUILD = "import sys, setuptools.build_meta as b; getattr(b, sys.argv[1])(sys.argv[2])"


def build(source, target, into, **environment):
    """Build a distribution without network; return its file."""
    into.mkdir()
    result = subprocess.run(
        [sys.executable, "-c", BUILD, f"build_{target}", into],
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
    """Import from an unpacked wheel, which lies before every other station."""
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
    environment = {k: v for k, v in os.environ.items() if k != "STATION_COMPILED"}
    result = subprocess.run(
        [sys.executable, "-c", SHOW],
        cwd=folder,
        env={
            **environment,
            **NO_COMPILER,
            "PYTHONPATH": str(folder),
        },
        capture_output=True,
        text=True,
        check=True,
    )
    mode, file = result.stdout.split()
    return mode, Path(file)


@pytest.mark.skipif(find_misfit() is not None, reason=str(find_misfit()))
def test_a_wheel_carries_extensions_that_run(tmp_path):
    root = copy_checkout(tmp_path / "checkout", keep_extensions=False)
    compile_only("memory", root)
    wheel = build(root, "wheel", tmp_path / "dist", STATION_COMPILED="1")
    folder = tmp_path / "installed"

    mode, file = run_unpacked(wheel, folder)

    assert mode == "compiled"
    assert file.is_relative_to(folder)
    assert file.suffix == ".so"
    version = f"cp{sys.version_info.major}{sys.version_info.minor}"
    assert f"-{version}-{version}" in wheel.name


def test_the_sdist_becomes_a_wheel_without_a_compiler(tmp_path):
    root = copy_checkout(tmp_path / "checkout", keep_extensions=False)
    sdist = build(root, "sdist", tmp_path / "sdist", **NO_COMPILER)
    with tarfile.open(sdist) as archive:
        archive.extractall(tmp_path, filter="data")
    source = tmp_path / sdist.name.removesuffix(".tar.gz")

    wheel = build(source, "wheel", tmp_path / "dist", **NO_COMPILER)

    assert wheel.name.endswith("-py3-none-any.whl")
    with zipfile.ZipFile(wheel) as archive:
        assert not [name for name in archive.namelist() if name.endswith(".so")]


def test_a_wheel_that_must_carry_extensions_is_not_built_without_a_compiler(tmp_path):
    root = copy_checkout(tmp_path / "checkout", keep_extensions=False)
    with pytest.raises(AssertionError, match="No C compiler was found"):
        build(
            root, "wheel", tmp_path / "dist", **NO_COMPILER | {"STATION_COMPILED": "1"}
        )
