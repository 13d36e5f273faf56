"""A kernel of one small module, with places of its own to be built in."""

import sys
from pathlib import Path

import pytest

from station.kernel import build, built, manifest, places
from station.kernel.manifest import (
    Manifest,
    file_digest,
    fingerprint,
    module_file,
    source_digest,
    target,
)

KERNEL = Path(places.__file__).parent


@pytest.fixture
def sources(tmp_path, monkeypatch):
    """Return the folder of a kernel that has the module `twice` alone."""
    folder = tmp_path / "sources"
    folder.mkdir()
    (folder / "twice.py").write_text(
        '"""Doubles."""\n\nimport cython\n\n'
        "KIND = 'compiled' if cython.compiled else 'interpreted'\n\n\n"
        "def twice(value: float) -> float:\n    return 2.0 * value\n"
    )
    (folder / "twice.pxd").write_text("cpdef double twice(double value) noexcept\n")
    (folder / "build.py").write_text((KERNEL / "build.py").read_text())
    for module in (places, manifest, build):
        monkeypatch.setattr(module, "SOURCES", folder)
    monkeypatch.setattr(sys, "prefix", str(tmp_path / "venv"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.delenv(built.SWITCH, raising=False)
    forget()
    yield folder
    forget()


@pytest.fixture
def environment(sources):
    """Return the folder of kernels in an environment that has none."""
    venv = sources.parent / "venv"
    place = venv / "share" / "control-station" / "kernel"
    place.mkdir(parents=True)
    return place


@pytest.fixture
def has_all_tools(monkeypatch):
    """Let every tool be there."""
    monkeypatch.setattr(built, "missing_tool", lambda: None)


def forget():
    """Forget what is remembered of the sources and kernels of this process."""
    built._fingerprint_at_start.cache_clear()
    built._is_sound.cache_clear()
    built._unloadable.clear()


def write_kernel(place, *, name=None, sources=None, built_for=None):
    """Write a kernel that fits but for what is given; return its directory."""
    directory = place / (name or fingerprint())
    directory.mkdir(parents=True)
    file = directory / module_file("twice")
    file.write_text("a library")
    modules = {file.name: file_digest(file)}
    found = Manifest(sources or source_digest(), built_for or target(), modules)
    found.write(directory)
    return directory
