"""Where compiled kernels lie: in the package, the environment, the user's cache."""

import os
import stat
import sys
from pathlib import Path

SOURCES = Path(__file__).parent
"""Where the sources of the kernel are."""
_SHARE = Path("control-station") / "kernel"


def package_place() -> Path:
    """Return where a wheel carries its kernel."""
    return SOURCES / "compiled"


def environment_place() -> Path | None:
    """Return where kernels are built in a virtual environment; None outside of one.

    A Python that is not a virtual environment is the system's or belongs to several
    programs: nothing is written into it.
    """
    if sys.prefix == sys.base_prefix:
        return None
    return Path(sys.prefix) / "share" / _SHARE


def cache_place() -> Path | None:
    """Return where kernels are built otherwise; None for a user without a home."""
    base = os.environ.get("XDG_CACHE_HOME", "")
    if Path(base).is_absolute():
        return Path(base) / _SHARE
    try:
        return Path.home() / ".cache" / _SHARE
    except RuntimeError:
        return None


def places() -> list[Path]:
    """Return all places with kernels that may be loaded, the preferred one first.

    The cache is left out while others than the user could have put something into it.
    """
    found = [package_place()]
    if (environment := environment_place()) is not None:
        found.append(environment)
    if (cache := cache_place()) is not None and _is_private(cache):
        found.append(cache)
    return [place for place in found if place.is_dir()]


def building_place() -> Path | None:
    """Return where a kernel can be built; None when no place can be written."""
    for place in (environment_place(), cache_place()):
        if place is not None and _can_write(place):
            return place
    return None


def _can_write(place: Path) -> bool:
    """Return whether a directory can be written, or made where it is missing."""
    existing = next(p for p in (place, *place.parents) if p.exists())
    return existing.is_dir() and os.access(existing, os.W_OK | os.X_OK)


def _is_private(place: Path) -> bool:
    """Return whether only this user and root can change what lies in a directory."""
    try:
        info = place.stat()
    except OSError:
        return False
    shared = stat.S_IWGRP | stat.S_IWOTH
    return info.st_uid in {os.getuid(), 0} and not info.st_mode & shared
