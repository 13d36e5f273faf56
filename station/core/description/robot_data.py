"""The location of example-robot-data's robots on this machine.

All of them come with that package, 430 MB. The Panda alone can be fetched into the
user's own directory, in the same layout.
"""

import importlib.metadata
import os
from functools import cache
from pathlib import Path

DISTRIBUTION = "example-robot-data"
HOME_VARIABLE = "STATION_ROBOT_DATA"
# Where the wheel of that distribution puts its data; relative to its install root.
_INSTALLED = "cmeel.prefix/share/example-robot-data"


def data_directories() -> list[Path]:
    """Return the directories that hold `robots/`, the most complete one first."""
    installed = _installed_directory()
    candidates = [fetched_directory()]
    if installed is not None:
        candidates.insert(0, installed)
    return [path for path in candidates if (path / "robots").is_dir()]


def is_complete() -> bool:
    """Return whether all robots of example-robot-data are installed."""
    return _installed_directory() is not None


def fetched_directory() -> Path:
    """Return the directory of fetched robots; it need not exist.

    It is `example-robot-data` below `$STATION_ROBOT_DATA`, or below
    `$XDG_DATA_HOME/control-station`. Mesh files are named `package://example-robot-data/`,
    so the last part of the path is fixed.
    """
    home = os.environ.get(HOME_VARIABLE)
    if home:
        return Path(home).expanduser().absolute() / DISTRIBUTION
    data = os.environ.get("XDG_DATA_HOME") or "~/.local/share"
    return Path(data).expanduser().absolute() / "control-station" / DISTRIBUTION


@cache
def _installed_directory() -> Path | None:
    try:
        distribution = importlib.metadata.distribution(DISTRIBUTION)
    except importlib.metadata.PackageNotFoundError:
        return None
    directory = Path(str(distribution.locate_file(_INSTALLED)))
    return directory if (directory / "robots").is_dir() else None
