"""Compile the kernel: `python -m station.kernel.build`.

The modules that an earlier kernel has are taken over: to compile all of them takes two
minutes of a processor, to compile what one change concerns some seconds.

Needs Cython, a C compiler and Python's header files. The result is put in place as a
whole, so that a station that starts meanwhile finds either a complete kernel or none.
"""

import argparse
import fcntl
import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import cython

from station.kernel.built import (
    FAILURE,
    LOCK,
    SWITCH,
    compiled_modules,
    fitting_kernel,
)
from station.kernel.manifest import (
    Manifest,
    file_digest,
    fingerprint,
    kernel_modules,
    module_file,
    module_recipes,
    source_digest,
    target,
)
from station.kernel.places import SOURCES, building_place
from station.kernel.toolchain import (
    compiler_version,
    find_compiler,
    include_directories,
    missing_tool,
)

# Nothing but the baseline of the processor's family, and no contraction to fused
# operations, which round differently.
_COMPILER_FLAGS = (
    *("-O2", "-fPIC", "-shared", "-pthread", "-fwrapv", "-w"),
    *("-ffp-contract=off", "-fno-fast-math"),
)
# Cython counts the users of a view with atomic operations, some fifty in a cycle, each
# of which waits for a line of the cache. All of them hold the interpreter lock, where
# there is one.
_PLAIN_COUNTS = (
    "-D__STDC_NO_ATOMICS__",
    "-D__sync_fetch_and_add(place, change)=((*(place) += (change)) - (change))",
    "-D__sync_fetch_and_sub(place, change)=((*(place) -= (change)) + (change))",
)
# A view in an object takes 64 bytes in place of 208 if arrays have one dimension alone.
_CYTHON = (
    "from Cython.Compiler import Options; Options.buffer_max_dims = 2; "
    "from Cython.Compiler.Main import main; main(command_line=1)"
)
_DIRECTIVES = {
    "boundscheck": False,
    "wraparound": False,
    "initializedcheck": False,
    "cdivision": True,
    "infer_types": True,
    # The types are those of the .pxd; `int` in the .py would be a Python object.
    "annotation_typing": False,
}
_SHARED = "shared_by_all"
"""What all compiled modules need of Cython's own, compiled once instead of in each."""
_KEPT = 4
"""How many kernels a place keeps: going back to another branch costs no build."""
_TIMEOUT = 600.0
"""How long one command may take on a machine that has better things to do [s]."""
_SCRATCH = ".building-"


class BuildError(RuntimeError):
    """The kernel cannot be built."""


def build(*, jobs: int | None = None) -> Path:
    """Build the kernel unless one that fits is there; return its directory.

    Args:
        jobs: How many modules are compiled at the same time; None: as many as there
            are processors.

    Raises:
        BuildError: A tool is missing, no place can be written, or a compiler fails.
    """
    if (found := fitting_kernel()) is not None:
        return found
    with _locked() as place:
        return _build_in(place, jobs or len(os.sched_getaffinity(0)))


def build_in_background() -> None:
    """Let a process of its own build the kernel in idle time; return at once.

    The process outlives the caller, and the place is locked when this returns, so that
    everybody sees that a kernel is being built. Call it in a process without threads.

    Raises:
        BuildError: A tool is missing, or no place can be written.
    """
    with _locked() as place:
        if os.fork():
            return  # the lock belongs to both, and is held until the child ends, too
        status = 1
        try:
            os.setsid()
            os.setpriority(os.PRIO_PROCESS, 0, 19)
            os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))
            # In idle time, so that all processors may help.
            _build_in(place, jobs=len(os.sched_getaffinity(0)))
            status = 0
        finally:
            os._exit(status)


def build_into(directory: Path, scratch: Path, *, jobs: int) -> None:
    """Compile every module of the kernel.

    Args:
        directory: Where the compiled modules and their manifest go; it is made.
        scratch: An empty directory for what lies between.
        jobs: How many modules are compiled at the same time, >= 1.

    Raises:
        BuildError: A compiler fails.
    """
    sources = source_digest()
    package = scratch / "station" / "kernel"
    package.mkdir(parents=True)
    for folder in (package, package.parent):
        (folder / "__init__.py").touch()
    for name in kernel_modules():
        shutil.copy(SOURCES / f"{name}.py", package)
        shutil.copy(SOURCES / f"{name}.pxd", package)
    directory.mkdir()
    tools = f"{cython.__version__} {find_compiler()} {compiler_version()}"
    how = f"{tools} {_CYTHON} {_compiler_flags()} {_DIRECTIVES}"
    recipes = {_SHARED: f"{how} {target()}", **module_recipes(how)}
    compiled = compiled_modules()

    def make(name: str) -> Path:
        before = compiled.get(recipes[name])
        if before is None:
            return _compile(name, scratch, directory)
        return Path(shutil.copy(before, directory / module_file(name)))

    with ThreadPoolExecutor(jobs) as executor:
        made = list(executor.map(make, recipes))
    if source_digest() != sources:
        raise BuildError("The sources have changed during the build.")
    modules = {path.name: file_digest(path) for path in made}
    kept = {module_file(name): recipe for name, recipe in recipes.items()}
    Manifest(sources, target(), modules, kept).write(directory)


def _build_in(place: Path, jobs: int) -> Path:
    """Build the kernel in a place that is locked, and clean the place up.

    Raises:
        BuildError: A compiler fails.
        OSError: The place is full, or not what it was.
    """
    # Another process may have built it while this one waited for the lock.
    if (found := fitting_kernel()) is not None:
        return found
    final = place / fingerprint()
    failure = place / f"{final.name}{FAILURE}"
    with tempfile.TemporaryDirectory(dir=place, prefix=_SCRATCH) as folder:
        built, scratch = Path(folder) / "kernel", Path(folder) / "scratch"
        scratch.mkdir()
        try:
            build_into(built, scratch, jobs=jobs)
            _try_import(built)
        except (BuildError, OSError) as error:
            failure.write_text(f"{error}\n", encoding="utf-8")
            raise
        if final.exists():  # damaged; it is deleted with the temporary directory
            final.rename(Path(folder) / "damaged")
        built.rename(final)
    _clean_up(place, final)
    return final


def _compiler_flags() -> tuple[str, ...]:
    if sysconfig.get_config_var("Py_GIL_DISABLED"):
        return _COMPILER_FLAGS
    return *_COMPILER_FLAGS, *_PLAIN_COUNTS


def _compile(name: str, tree: Path, directory: Path) -> Path:
    """Compile one module and return the file that Python can import."""
    code = f"{name}.c"
    cython = [sys.executable, "-c", _CYTHON, "-3"]
    if name == _SHARED:
        _run([*cython, "--generate-shared", code], tree)
    else:
        directives = ",".join(f"{key}={value}" for key, value in _DIRECTIVES.items())
        shared = ["--shared", f"station.kernel.{_SHARED}"]
        source = f"station/kernel/{name}.py"
        _run([*cython, "-X", directives, *shared, "-o", code, source], tree)
    result = directory / module_file(name)
    includes = [f"-I{folder}" for folder in include_directories()]
    compiler = find_compiler() or ["cc"]
    _run(
        [*compiler, *_compiler_flags(), *includes, code, "-o", str(result), "-lm"], tree
    )
    return result


def _try_import(directory: Path) -> None:
    """Import the compiled modules in another process, in place of the sources.

    Args:
        directory: Where they are.

    Raises:
        BuildError: A module cannot be imported.
    """
    names = ", ".join(f"station.kernel.{name}" for name in kernel_modules())
    code = (
        f"import os; os.environ[{SWITCH!r}] = '0'; import station.kernel; "
        f"station.kernel.__path__.insert(0, {str(directory)!r}); "
        f"import {names}"
    )
    _run([sys.executable, "-c", code], SOURCES.parents[1])


def _run(command: list[str], directory: Path) -> None:
    """Run a command in a directory.

    Raises:
        BuildError: It fails.
    """
    try:
        subprocess.run(
            command,
            cwd=directory,
            check=True,
            timeout=_TIMEOUT,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
        )
    except subprocess.CalledProcessError as error:
        raise BuildError(f"{' '.join(command)}:\n{error.stdout}") from error
    except (OSError, subprocess.TimeoutExpired) as error:
        raise BuildError(f"{' '.join(command)}: {error}") from error


@contextmanager
def _locked() -> Iterator[Path]:
    """Lock the place where the kernel is built: one process at a time builds there.

    Raises:
        BuildError: A tool is missing, or no place can be written.
    """
    if (missing := missing_tool()) is not None:
        raise BuildError(missing)
    if (place := building_place()) is None:
        raise BuildError("Neither the environment nor the cache can be written.")
    place.mkdir(parents=True, exist_ok=True)
    with (place / LOCK).open("ab") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield place


def _clean_up(place: Path, newest: Path) -> None:
    """Remove old kernels, and what builds have left that were killed."""
    for scratch in place.glob(f"{_SCRATCH}*"):
        shutil.rmtree(scratch, ignore_errors=True)
    os.utime(newest)
    kernels = [path for path in place.iterdir() if path.is_dir()]
    kernels.sort(key=lambda path: path.stat().st_mtime, reverse=True)
    for old in kernels[_KEPT:]:
        # What a running station has loaded stays loaded.
        shutil.rmtree(old, ignore_errors=True)
    for failure in place.glob(f"*{FAILURE}"):
        failure.unlink(missing_ok=True)


def main() -> int:
    """Build the kernel and print where it is; return 1 when that is impossible."""
    parser = argparse.ArgumentParser(prog="python -m station.kernel.build")
    parser.add_argument(
        "--background",
        action="store_true",
        help="do not wait for it; compile in idle time alone",
    )
    parser.add_argument(
        "--optional",
        action="store_true",
        help="say what is missing, but do not fail, on a machine that lacks a tool",
    )
    options = parser.parse_args()
    missing = missing_tool() if fitting_kernel() is None else None
    if missing and options.optional:
        sys.stderr.write(f"kernel: not compiled. {missing}\n")
        return 0
    try:
        if options.background:
            build_in_background()
        else:
            sys.stdout.write(f"{build()}\n")
    except (BuildError, OSError) as error:
        sys.stderr.write(f"kernel: not compiled. {error}\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
