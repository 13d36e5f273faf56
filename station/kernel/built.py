"""Find the compiled kernel that fits the sources, this Python and this machine."""

import fcntl
import importlib
import os
import sys
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Literal

from station.kernel.manifest import (
    MANIFEST,
    file_digest,
    find_damage,
    fingerprint,
    kernel_modules,
    read_manifest,
    source_digest,
    target,
)
from station.kernel.places import building_place, places
from station.kernel.toolchain import missing_tool

SWITCH = "STATION_COMPILED"
"""Environment variable: 0 runs the kernel interpreted, 1 refuses to."""
LOCK = ".lock"
"""Name of the file that a build keeps locked."""
FAILURE = ".failed"
"""Ending of the file that tells why a kernel could not be built."""
_PACKAGE = "station.kernel"
_CANNOT_IMPORT = (ImportError, AttributeError, SystemError, TypeError, ValueError)
"""What Python and compiled modules raise when a library is not what it should be."""
_unloadable: dict[Path, int] = {}
"""Kernels that this process could not import, and when they were changed last [ns]."""
_BEING_BUILT = "A compiled kernel is being built; the next start loads it."


@dataclass(frozen=True, slots=True)
class KernelStatus:
    """Which kernel runs.

    Attributes:
        mode: Whether the compiled modules run or their sources.
        reason: Why it is this one, in whole sentences.
        directory: Where the compiled modules are; None when the kernel is interpreted.
        is_forced: Whether the user has asked for this one.
    """

    mode: Literal["compiled", "interpreted"]
    reason: str
    directory: Path | None = None
    is_forced: bool = False

    @property
    def is_compiled(self) -> bool:
        """Whether the compiled modules run."""
        return self.mode == "compiled"

    def text(self) -> str:
        """Return both for a line of a table or a log."""
        return f"{self.mode}: {self.reason}"


def find_kernel() -> KernelStatus:
    """Return which kernel to run.

    Raises:
        ImportError: `STATION_COMPILED=1`, and no compiled kernel fits; or the variable
            has another value than 0 or 1.
    """
    wanted = os.environ.get(SWITCH, "")
    if wanted not in {"", "0", "1"}:
        raise ImportError(
            f"{SWITCH} is '{wanted}'. It must be 0 (run the kernel interpreted), "
            "1 (run it compiled or not at all), or unset."
        )
    if wanted == "0":
        reason = f"{SWITCH}=0 asks for it."
        return KernelStatus("interpreted", reason, is_forced=True)
    if (directory := fitting_kernel()) is not None:
        reason = f"It was built from these sources for {target()}."
        return KernelStatus("compiled", reason, directory, is_forced=wanted == "1")
    reason = _why_interpreted()
    if wanted == "1":
        raise ImportError(
            f"{SWITCH}=1, but no compiled kernel can run. {reason} Build it with "
            f"`{SWITCH}= python -m station.kernel.build`."
        )
    return KernelStatus("interpreted", reason)


def load_kernel(status: KernelStatus, path: list[str]) -> KernelStatus:
    """Import the compiled modules, if there are any, and return which kernel runs.

    Args:
        status: What `find_kernel` returned.
        path: Where Python looks for the modules of the package. The directory of the
            compiled modules, which have the same names, becomes its first element.

    Raises:
        ImportError: The kernel cannot be imported, and `STATION_COMPILED=1`.
    """
    if status.directory is None:
        return status
    path.insert(0, str(status.directory))
    names = [f"{_PACKAGE}.{name}" for name in kernel_modules()]
    try:
        for name in names:
            importlib.import_module(name)
    except _CANNOT_IMPORT as error:
        if status.is_forced:
            raise
        path.pop(0)
        for name in names:
            sys.modules.pop(name, None)
        _unloadable[status.directory] = status.directory.stat().st_mtime_ns
        found = f"The kernel at {status.directory} cannot be imported: {error}."
        return KernelStatus("interpreted", _why_interpreted(found))
    return status


def fitting_kernel() -> Path | None:
    """Return the directory of a sound kernel that fits; None without one."""
    name = fingerprint()
    for place in places():
        directory = place / name
        if not directory.is_dir() or _is_unloadable(directory):
            continue
        if find_damage(directory) is None:
            return directory
    return None


def compiled_modules() -> dict[str, Path]:
    """Return the compiled modules of all kernels, by the hash of what they are made of.

    A build takes over those that it would make anew.
    """
    found: dict[str, Path] = {}
    for manifest_file in (m for p in places() for m in p.glob(f"*/{MANIFEST}")):
        directory = manifest_file.parent
        manifest = read_manifest(directory)
        if manifest is None or manifest.target != target():
            continue
        for name, recipe in manifest.recipes.items():
            path = directory / name
            sound = path.is_file() and file_digest(path) == manifest.modules.get(name)
            if recipe not in found and sound:
                found[recipe] = path
    return found


def present_status(status: KernelStatus) -> KernelStatus:
    """Return which kernel runs, and what has happened to the kernels since the start.

    Args:
        status: Which kernel the process has loaded.
    """
    if status.is_compiled or status.is_forced:
        return status
    if _has_been_built():
        reason = "A compiled kernel has been built meanwhile; the next start loads it."
        return KernelStatus("interpreted", reason)
    if is_being_built():
        return KernelStatus("interpreted", _BEING_BUILT)
    return status


def _has_been_built() -> bool:
    name = _fingerprint_at_start()
    directories = [place / name for place in places() if (place / name).is_dir()]
    return any(
        _is_sound(path, path.stat().st_mtime_ns)
        for path in directories
        if not _is_unloadable(path)
    )


def _is_unloadable(directory: Path) -> bool:
    """Return whether this process could not import the kernel that is there."""
    return _unloadable.get(directory) == directory.stat().st_mtime_ns


@lru_cache(maxsize=1)
def _fingerprint_at_start() -> str:
    """Return the fingerprint without reading the sources at each look."""
    return fingerprint()


@lru_cache(maxsize=8)
def _is_sound(directory: Path, changed: int) -> bool:  # noqa: ARG001 - see below
    """Look at a kernel once, and once more when it has changed."""
    return find_damage(directory) is None


def needs_building(status: KernelStatus) -> bool:
    """Return whether a compiled kernel is missing and can be built here.

    Args:
        status: Which kernel the process has loaded.
    """
    return (
        not status.is_compiled
        and not status.is_forced
        and building_place() is not None
        and missing_tool() is None
        and find_failure() is None
        and fitting_kernel() is None
        and not is_being_built()
    )


def find_failure() -> Path | None:
    """Return the file that tells why the kernel could not be built, if there is one."""
    name = f"{_fingerprint_at_start()}{FAILURE}"
    return next((p / name for p in places() if (p / name).is_file()), None)


def is_being_built() -> bool:
    """Return whether some process builds a kernel at this moment."""
    return any(_is_locked(place / LOCK) for place in places())


def _is_locked(path: Path) -> bool:
    try:
        with path.open("rb") as file:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return False
    return False


def _why_interpreted(found: str | None = None) -> str:
    """Return why no compiled kernel runs, and what would change that.

    Args:
        found: What the kernels are like that there are; looked up when None.
    """
    if is_being_built():
        return _BEING_BUILT
    found = found or _why_none_fits()
    if (failure := find_failure()) is not None:
        return (
            f"{found} Building one failed, see {failure}; when the cause is gone, "
            "`python -m station.kernel.build` builds it."
        )
    if (missing := missing_tool()) is not None:
        return f"{found} {missing}"
    if building_place() is None:
        return f"{found} There is no directory to build one in that can be written."
    return f"{found} `station run` builds one beside the station."


def _why_none_fits() -> str:
    """Return what the kernels are like that there are."""
    name, sources = fingerprint(), source_digest()
    stale: Path | None = None
    for place in places():
        if (place / name).is_dir():
            return (
                f"The kernel at {place / name} is damaged: {find_damage(place / name)}"
            )
        for directory in sorted(place.iterdir()):
            if (manifest := read_manifest(directory)) is None:
                continue
            if manifest.sources == sources:
                return (
                    f"The kernel at {directory} is for {manifest.target}, and this is "
                    f"{target()}."
                )
            stale = directory
    if stale is not None:
        return f"The kernel at {stale} is stale: it was built from other sources."
    return "There is no compiled kernel."
