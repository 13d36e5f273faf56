"""Find what compiling the kernel needs: a C compiler, Python's headers, Cython."""

import os
import shlex
import shutil
import subprocess
import sys
import sysconfig
from importlib.util import find_spec
from pathlib import Path

_COMPILERS = ("cc", "gcc", "clang")


def find_compiler() -> list[str] | None:
    """Return the command of the C compiler; None when there is none.

    `CC` of the environment comes first, then the compiler that built this Python.
    """
    built_with = sysconfig.get_config_var("CC") or ""
    for command in (os.environ.get("CC", ""), str(built_with), *_COMPILERS):
        words = shlex.split(command)
        if words and (path := shutil.which(words[0])):
            return [path, *words[1:]]
    return None


def compiler_version() -> str:
    """Return what the C compiler says of its version; empty if it says nothing."""
    command = find_compiler()
    if command is None:
        return ""
    asked = [*command, "--version"]
    try:
        told = subprocess.run(asked, capture_output=True, timeout=10.0, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return told.stdout.decode(errors="replace")


def include_directories() -> list[Path]:
    """Return the directories with the header files of this Python."""
    names = ("include", "platinclude")
    return [Path(d) for d in dict.fromkeys(map(sysconfig.get_path, names))]


def missing_tool() -> str | None:
    """Return what is missing for a build, one sentence; None when all is there."""
    if find_compiler() is None:
        return "No C compiler was found; install one (Debian, Ubuntu: gcc)."
    if not any((folder / "Python.h").is_file() for folder in include_directories()):
        name = f"python{sys.version_info.major}.{sys.version_info.minor}-dev"
        return f"Python's header files are missing (Debian, Ubuntu: {name})."
    if find_spec("Cython") is None:
        return "Cython is not installed."
    return None
