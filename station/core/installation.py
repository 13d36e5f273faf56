"""The extras of this distribution, and the commands that install them."""

import json
import sys
from collections.abc import Mapping
from pathlib import Path

from typing_extensions import override

from station.core.errors import StationError

NAME = "control-station"
EXTRAS: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(("cython", "numpy"), ("core", "sim")),
    **dict.fromkeys(("fastapi_offline", "orjson"), ("server",)),
    **dict.fromkeys(
        ("anyio", "fastapi", "msgspec", "starlette", "uvicorn"), ("server", "ui")
    ),
    **dict.fromkeys(("mujoco", "ruckig"), ("sim",)),
    "trimesh": ("sim", "ui"),
    **dict.fromkeys(("PIL", "viser", "yourdfpy"), ("ui",)),
    "gymnasium": ("gym",),
    **dict.fromkeys(("foxglove", "lz4", "mcap"), ("records",)),
    **dict.fromkeys(("cma", "matplotlib", "pandas", "scipy"), ("experiments",)),
    "pyarrow": ("export", "experiments"),
    "distributed": ("cluster",),
    "mcp": ("mcp",),
}
"""The extras of this distribution that bring a package which `station` imports."""


class MissingExtraError(StationError, ModuleNotFoundError):
    """A function needs a package that an extra of this distribution brings.

    Args:
        package: The package, a key of `EXTRAS`.
    """

    code = "missing_extra"

    def __init__(self, package: str) -> None:
        extras = EXTRAS[package]
        super().__init__(
            f"The package '{package}' is not installed; {NAME} brings it with the "
            f"extra {' or '.join(extras)}.",
            remedy=f"Install it: {install_command(extras[-1])}. `station run` uses the "
            "extra 'all'.",
            details={"package": package, "extras": list(extras)},
        )

    @override
    def __str__(self) -> str:
        """Return message and remedy: a traceback shows nothing else of the error."""
        return f"{self.message} {self.remedy}"


def missing_extra(error: ImportError) -> MissingExtraError | None:
    """Return the message for a failed import; None if no extra brings the package.

    Args:
        error: The error of the import.
    """
    package = (error.name or "").partition(".")[0]
    is_absent = isinstance(error, ModuleNotFoundError)
    return MissingExtraError(package) if is_absent and package in EXTRAS else None


def install_command(extra: str) -> str:
    """Return the command that adds an extra to this installation.

    It names the place where this installation comes from: a checkout, an address of
    Git, a file, or an index.

    Args:
        extra: An extra of this distribution, e.g. `sim`.
    """
    origin = _origin()
    checkout = _checkout(origin)
    if checkout is not None:
        if Path(sys.prefix) == checkout / ".venv":
            return f"make -C {checkout} setup"
        return f"pip install -e '{checkout}[{extra}]'"
    url = origin.get("url")
    if not isinstance(url, str):
        return f"pip install '{NAME}[{extra}]'"
    version = origin.get("vcs_info")
    if isinstance(version, dict):
        url = f"{version.get('vcs', 'git')}+{url}@{version.get('commit_id', 'HEAD')}"
    return f"pip install '{NAME}[{extra}] @ {url}'"


def _origin() -> Mapping[str, object]:
    """Return the origin of this installation; empty if it is from an index.

    Source: PyPA specification "Recording the Direct URL Origin of installed
    distributions", `direct_url.json`.
    """
    # Imported on demand: these imports take longer than most verbs of the command line.
    from importlib.metadata import PackageNotFoundError, distribution

    try:
        text = distribution(NAME).read_text("direct_url.json")
    except PackageNotFoundError:
        text = None
    found = json.loads(text) if text else {}
    return found if isinstance(found, dict) else {}


def _checkout(origin: Mapping[str, object]) -> Path | None:
    """Return the directory of an installation that runs from its source."""
    folder = origin.get("dir_info")
    if isinstance(folder, dict) and folder.get("editable") is True:
        from urllib.parse import unquote, urlparse

        return Path(unquote(urlparse(str(origin.get("url"))).path))
    # Not installed at all: the source lies on the path.
    source = Path(__file__).parents[2]
    is_source = not origin and (source / "pyproject.toml").is_file()
    return source if is_source else None
