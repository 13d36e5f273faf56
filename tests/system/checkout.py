"""A copy of this checkout, in which a test may build."""

import shutil
from pathlib import Path

from tests.system.station_process import ROOT

_FILES = ("setup.py", "pyproject.toml", "MANIFEST.in", "README.md", "LICENSE")


def copy_checkout(folder: Path, *, keep_extensions: bool) -> Path:
    """Copy what a build and a start need; return where the copy is.

    Args:
        folder: Where to; it must not exist.
        keep_extensions: Whether the compiled extensions come along, with what a build
            of one of them needs, so that the others are not compiled again.
    """
    ignored = shutil.ignore_patterns(
        "__pycache__", *([] if keep_extensions else ["*.so", "compiled.*.json"])
    )
    shutil.copytree(ROOT / "station", folder / "station", ignore=ignored)
    if keep_extensions:
        shutil.copytree(ROOT / "build", folder / "build")
    for name in _FILES:
        shutil.copy2(ROOT / name, folder)
    return folder


def compile_only(room: str, folder: Path) -> None:
    """Let a copy compile the modules of one room alone: of all it takes minutes.

    Args:
        room: Folder of `station/`; its modules need no compiled ones of others.
        folder: The copy.
    """
    for declarations in (folder / "station").rglob("*.pxd"):
        if not declarations.is_relative_to(folder / "station" / room):
            declarations.unlink()
