"""Decide for a process whether the compiled extensions run or their Python sources.

A module of the control cycle has a `.pxd` file beside it, which gives Cython the types
of C. `setup.py` compiles such a module; the extension lies beside its source and
returns the same bits. Extensions share the layout of their objects, so a process runs
all of them or none. The first import of such a module decides.
"""

import fcntl
import hashlib
import json
import os
import shlex
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Literal

from station.compiled_finder import SHARED, SUFFIX

SWITCH = "STATION_COMPILED"
"""Environment variable: 0 runs the sources, 1 the extensions or nothing."""
PACKAGE = Path(__file__).parent
_MACHINE = os.uname()
_TARGET = f"{sysconfig.get_config_var('SOABI')} {_MACHINE.sysname} {_MACHINE.machine}"
_BEING_BUILT = "Compiled extensions are being built; the next start loads them."


@dataclass(frozen=True, slots=True)
class CompilationStatus:
    """State of a process: it runs the extensions or the sources.

    Attributes:
        mode: `interpreted` or `compiled`.
        reason: Why, in whole sentences.
        is_forced: Whether the user has asked for it by `STATION_COMPILED`.
    """

    mode: Literal["compiled", "interpreted"]
    reason: str
    is_forced: bool = False

    @property
    def is_compiled(self) -> bool:
        """Return whether the extensions run."""
        return self.mode == "compiled"

    def text(self) -> str:
        """Return mode and reason as one line for a table or a log."""
        return f"{self.mode}: {self.reason}"


@dataclass(frozen=True, slots=True)
class BuildRecord:
    """Record of the extensions of a build, which writes it after the last extension.

    Attributes:
        sources: Digest of the sources.
        recipe: Digest of `setup.py`: with other flags the same sources become other
            extensions.
        target: Python, operating system and processor that can load them.
        extensions: Digest of each extension, by its path below the package.
        failure: Why the build failed; empty if it succeeded.
    """

    sources: str
    recipe: str
    target: str
    extensions: dict[str, str]
    failure: str = ""

    def write(self, package: Path | None = None) -> None:
        """Write the record into a package, whole or not at all."""
        path = record_path(package)
        scratch = path.with_suffix(".tmp")
        scratch.write_text(json.dumps(asdict(self), indent=2) + "\n", encoding="utf-8")
        scratch.replace(path)


def record_path(package: Path | None = None) -> Path:
    """Return the path of the record of the extensions for this Python."""
    return (package or PACKAGE) / f"compiled{SUFFIX.removesuffix('.so')}.json"


def read_record() -> BuildRecord | None:
    """Return the record of the last build; None if it is missing or damaged."""
    try:
        return BuildRecord(**json.loads(record_path().read_text("utf-8")))
    except (OSError, ValueError, TypeError):
        return None


def compiled_modules() -> dict[str, Path]:
    """Return the sources of the modules that are compiled, by name, sorted."""
    types = (
        Path(folder, file)
        for folder, _, files in os.walk(PACKAGE)
        for file in files
        if file.endswith(".pxd")
    )
    sources = sorted(path.with_suffix(".py") for path in types)
    return {_module_name(path): path for path in sources}


def recipe_digest() -> str | None:
    """Return the digest of `setup.py`; None in an installed package."""
    recipe = PACKAGE.parent / "setup.py"
    return file_digest(recipe) if recipe.is_file() else None


def _module_name(source: Path) -> str:
    return ".".join(source.relative_to(PACKAGE.parent).with_suffix("").parts)


def source_digest() -> str:
    """Return the digest of the sources that are compiled."""
    digest = hashlib.sha256()
    for name, source in compiled_modules().items():
        digest.update(f"{name}\n".encode())
        digest.update(source.read_bytes())
        digest.update(source.with_suffix(".pxd").read_bytes())
    return digest.hexdigest()


def built_record(package: Path) -> BuildRecord:
    """Return the record of the extensions that lie in a package now.

    Raises:
        OSError: An extension is missing.
    """
    names = [SHARED, *compiled_modules()]
    paths = [f"{name.partition('.')[2].replace('.', '/')}{SUFFIX}" for name in names]
    found = {path: file_digest(package / path) for path in paths}
    return BuildRecord(source_digest(), recipe_digest() or "", _TARGET, found)


def file_digest(path: Path) -> str:
    """Return the digest of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


@cache
def status() -> CompilationStatus:
    """Return the implementation that this process runs; the first call decides.

    Raises:
        ImportError: `STATION_COMPILED=1`, and no extensions fit; or the variable has
            another value than 0 or 1.
    """
    wanted = os.environ.get(SWITCH, "")
    if wanted not in {"", "0", "1"}:
        raise ImportError(
            f"{SWITCH} is '{wanted}'. It must be 0 (run the Python sources), "
            "1 (run the compiled extensions or nothing), or unset."
        )
    if wanted == "0":
        return CompilationStatus(
            "interpreted", f"{SWITCH}=0 asks for it.", is_forced=True
        )
    misfit = find_misfit()
    if misfit is None:
        reason = f"It was built from these sources for {_TARGET}."
        return CompilationStatus("compiled", reason, wanted == "1")
    reason = f"{misfit} {_prospect()}"
    if wanted == "1":
        raise ImportError(f"{SWITCH}=1, but: {reason} `make compile` builds them.")
    return CompilationStatus("interpreted", reason)


def find_misfit() -> str | None:
    """Return the reason why the extensions cannot run; None if they can.

    Loading a truncated library would crash the process, so the digests are compared
    first.
    """
    record = read_record()
    if record is None or not record.extensions:
        return "There are no compiled extensions."
    if record.target != _TARGET:
        return f"The compiled extensions are for {record.target}; this is {_TARGET}."
    if not _is_of_these_sources(record):
        return "The compiled extensions are stale: they were built from other sources."
    for path, digest in record.extensions.items():
        if not (PACKAGE / path).is_file() or file_digest(PACKAGE / path) != digest:
            return f"The compiled extension {path} is missing or damaged."
    return None


def present_status() -> CompilationStatus:
    """Return the running implementation, and the state of a build since the start."""
    now = status()
    if now.is_compiled or now.is_forced:
        return now
    if is_being_built():
        return CompilationStatus("interpreted", _BEING_BUILT)
    if find_misfit() is None:
        reason = "Compiled extensions have been built; the next start loads them."
        return CompilationStatus("interpreted", reason)
    return now


def _prospect() -> str:
    """Return the sentence that says how to run the extensions instead."""
    if is_being_built():
        return _BEING_BUILT
    if failure := find_failure():
        return f"Building them failed: {failure} `make compile` tries again."
    if (missing := missing_tool()) is not None:
        return missing
    if not _is_checkout():
        return "Install the station anew where it finds a C compiler."
    return "`station run` builds them beside the station."


def missing_tool() -> str | None:
    """Return a sentence about the missing build tool; None if nothing is missing."""
    built_with = str(sysconfig.get_config_var("CC") or "")
    commands = (os.environ.get("CC", ""), built_with, "cc", "gcc", "clang")
    words = [shlex.split(command) for command in commands]
    if not any(command and shutil.which(command[0]) for command in words):
        return "No C compiler was found; install one (Debian, Ubuntu: gcc)."
    if not Path(sysconfig.get_path("include"), "Python.h").is_file():
        name = f"python{sys.version_info.major}.{sys.version_info.minor}-dev"
        return f"Python's header files are missing (Debian, Ubuntu: {name})."
    for module, name in (("Cython", "Cython"), ("setuptools", "Setuptools")):
        if find_spec(module) is None:
            return f"{name} is not installed."
    return None


def find_failure() -> str:
    """Return the reason why these sources failed to build; empty otherwise."""
    record = read_record()
    if record is None or not _is_of_these_sources(record):
        return ""
    return record.failure


def _is_of_these_sources(record: BuildRecord) -> bool:
    is_of_this_recipe = recipe_digest() in {None, record.recipe}
    return is_of_this_recipe and record.sources == source_digest()


def needs_building() -> bool:
    """Return whether extensions are missing and can be built in this checkout."""
    now = status()
    return (
        not now.is_compiled
        and not now.is_forced
        and _is_checkout()
        and missing_tool() is None
        and not find_failure()
        and find_misfit() is not None
        and not is_being_built()
    )


def stamps() -> dict[str, int]:
    """Return the time at which each extension was written [ns], by path."""
    record = read_record()
    paths = [] if record is None else [PACKAGE / path for path in record.extensions]
    return {str(path): path.stat().st_mtime_ns for path in paths}


def _is_checkout() -> bool:
    root = PACKAGE.parent
    return (root / "setup.py").is_file() and os.access(root, os.W_OK)


def _lock_path() -> Path:
    return PACKAGE.parent / "build" / "extensions.lock"


@contextmanager
def building(*, waits: bool = True) -> Iterator[int]:
    """Let one process at a time build, behind a lock that others can read.

    Args:
        waits: Whether to wait for a build that is under way.

    Yields:
        The descriptor of the lock. A process that inherits it goes on holding the lock.

    Raises:
        BlockingIOError: A build is under way.
        OSError: The lock's file cannot be written.
    """
    path = _lock_path()
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("ab") as file:
        fcntl.flock(file, fcntl.LOCK_EX | (0 if waits else fcntl.LOCK_NB))
        yield file.fileno()


def is_being_built() -> bool:
    """Return whether some process builds the extensions of this checkout now."""
    try:
        with _lock_path().open("rb") as file:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return False
    return False


def build_in_background() -> None:
    """Start a process that builds in idle time and outlives the caller.

    Raises:
        BlockingIOError: A build is under way.
        OSError: The process cannot be started.
    """
    build = [sys.executable, "setup.py", "--quiet", "build_ext", "--inplace"]
    with building(waits=False) as lock:
        # The process inherits the lock, so that the lock is never free in between.
        subprocess.Popen(
            [*build, "--idle", f"--lock={lock}"],
            cwd=PACKAGE.parent,
            pass_fds=[lock],
            start_new_session=True,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
