"""Find a robot's URDF, its SRDF and the mesh files that the URDF names.

The simulation and the dashboard both find them here, so that the dashboard draws the
robot that is simulated.
"""

import importlib.metadata
import os
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from urllib.parse import unquote, urlparse
from xml.etree import ElementTree

from station.core.description.urdf_text import parse_robot
from station.core.errors import RobotDescriptionError
from station.core.installation import install_command

DISTRIBUTION = "example-robot-data"
HOME_VARIABLE = "STATION_ROBOT_DATA"
# Directory of the data in the wheel of example-robot-data, below its install root.
_INSTALLED = "cmeel.prefix/share/example-robot-data"


def data_directories() -> list[Path]:
    """Return the directories that hold `robots/`, the most complete one first.

    The package example-robot-data holds all robots, 430 MB. The Panda alone can be
    fetched into the user's own directory, in the same layout.
    """
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


PACKAGE_SCHEME = "example-robot-data:"
_MAX_BYTES = 4_000_000
_FETCH_PANDA = (
    "Fetch it once with `station fetch_robot`, or give the path of a URDF. "
    "`station run` fetches it by itself."
)


@dataclass(frozen=True, slots=True)
class RobotFiles:
    """The files of one robot: a URDF that is well-formed XML, and its SRDF.

    Attributes:
        reference: Name by which they were found, e.g. `example-robot-data:panda`.
        urdf_path: The URDF file, absolute.
        xml: The text of the URDF.
        srdf_path: The SRDF of the same robot, or None if there is none beside the URDF.
    """

    reference: str
    urdf_path: Path
    xml: str
    srdf_path: Path | None

    def with_prefix(self, old: str, new: str) -> "RobotFiles":
        """Return the same robot under other names of links and joints.

        Args:
            old: The prefix to replace; names that do not begin with it stay.
            new: The prefix that takes its place.
        """
        if old == new:
            return self
        root = parse_robot(self.xml)
        for element in root.iter():
            for key in ("link", "joint", "reference"):
                if key in element.attrib:
                    element.set(key, replace_prefix(element.attrib[key], old, new))
            if element.tag in {"link", "joint"} and "name" in element.attrib:
                element.set("name", replace_prefix(element.attrib["name"], old, new))
        xml = ElementTree.tostring(root, encoding="unicode")
        return replace(self, xml=xml)

    def resolve_mesh(self, uri: str) -> Path:
        """Return the file that a mesh `filename` attribute of this URDF names.

        `package://<name>/…` is looked for in the directories above the URDF, in
        `ROS_PACKAGE_PATH`, and in example-robot-data.

        Args:
            uri: `package://…`, `file://…`, an absolute path, or a path relative to
                the URDF file.

        Returns:
            An existing file.

        Raises:
            RobotDescriptionError: There is no such file, or the scheme is unknown.
        """
        for candidate in self._candidates(uri):
            if candidate.is_file():
                return candidate.resolve()
        raise RobotDescriptionError(
            f"The mesh '{uri}' was not found.",
            remedy="Put the file there, or add its package's parent directory to "
            "ROS_PACKAGE_PATH.",
        )

    def _candidates(self, uri: str) -> list[Path]:
        parts = urlparse(uri)
        if parts.scheme == "package":
            relative = Path(parts.netloc, unquote(parts.path).lstrip("/"))
            return [root / relative for root in _package_roots(self.urdf_path)]
        if parts.scheme == "file":
            return [Path(unquote(parts.netloc + parts.path))]
        if parts.scheme == "":
            return [self.urdf_path.parent / uri]
        raise RobotDescriptionError(
            f"The mesh '{uri}' has the unknown scheme '{parts.scheme}'.",
            remedy="Use package://, file:// or a path.",
        )


def load_robot_files(reference: str) -> RobotFiles:
    """Find a robot's files and read its URDF.

    Args:
        reference: `example-robot-data:<robot>` (see `known_robots`) or the path of a
            URDF file.

    Returns:
        The files; whether the meshes exist is not checked.

    Raises:
        RobotDescriptionError: The robot is unknown, or the file is missing, cannot be
            read or is not a URDF.
    """
    if reference.startswith(PACKAGE_SCHEME):
        path = _find_known_robot(reference.removeprefix(PACKAGE_SCHEME).strip())
    else:
        path = Path(reference).expanduser().absolute()
    xml, name = _read(path)
    return RobotFiles(reference, path, xml, _find_srdf(path, name))


def replace_prefix(name: str, old: str, new: str) -> str:
    """Return `name` with `new` in place of the leading `old`, if it begins with it."""
    return new + name.removeprefix(old) if name.startswith(old) else name


def known_robots() -> dict[str, Path]:
    """Return the URDF file of every robot of example-robot-data on this machine.

    A robot has the name of its URDF file (`panda`, `ur5_robot`, `talos_left_arm`); a
    name that ends in `_robot` may be shortened (`ur5`).
    """
    return _robots_in(*data_directories())


def _robots_in(*directories: Path) -> dict[str, Path]:
    by_name: dict[str, Path] = {}
    for directory in reversed(directories):
        files = sorted((directory / "robots").glob("*/*/*.urdf"))
        by_name |= {path.stem: path for path in files}
        for path in files:
            if path.stem.endswith("_robot"):
                by_name[path.stem.removesuffix("_robot")] = path
    return by_name


# Searching all folders takes longer than reading a robot, so the result is kept.
_found_before = cache(_robots_in)


def _find_known_robot(name: str) -> Path:
    before = _found_before(*data_directories()).get(name)
    if before and before.is_file():
        return before
    robots = known_robots()
    if name in robots:
        return robots[name]
    if is_complete():
        raise RobotDescriptionError(
            f"example-robot-data has no robot '{name}'.",
            remedy=f"Choose one of {', '.join(sorted(robots))}.",
        )
    raise RobotDescriptionError(
        f"The robot '{name}' of example-robot-data is not on this machine.",
        remedy=_FETCH_PANDA if name == "panda" else _how_to_install_robots(),
    )


def _read(path: Path) -> tuple[str, str]:
    """Return the text of a URDF, and the robot's name in it.

    Raises:
        RobotDescriptionError: The file is missing, cannot be read or is not a URDF.
    """
    try:
        size = path.stat().st_size
        # Without a bound, a large file given by mistake would be read into memory.
        if size > _MAX_BYTES:
            raise RobotDescriptionError(
                f"{path} has {size} bytes; a URDF may have {_MAX_BYTES}.",
                remedy="Give the path of a URDF file.",
            )
        xml = path.read_text(encoding="utf-8")
    except OSError as exc:
        raise RobotDescriptionError(
            f"The robot description {path} cannot be read: {exc.strerror}.",
            remedy=f"Give the path of a URDF, or {PACKAGE_SCHEME}<robot>.",
        ) from exc
    except UnicodeDecodeError as exc:
        raise RobotDescriptionError(
            f"{path} is not a text in UTF-8: {exc}.",
            remedy="Give the path of a URDF file.",
        ) from exc
    if path.suffix == ".xacro":
        raise RobotDescriptionError(
            f"{path} is a xacro file, not a URDF.",
            remedy="Run xacro on it and give the path of the result.",
        )
    try:
        return xml, parse_robot(xml).get("name", "")
    except RobotDescriptionError as exc:
        raise RobotDescriptionError(
            f"{path}: {exc.message}", remedy=exc.remedy
        ) from exc


def _find_srdf(urdf_path: Path, robot: str) -> Path | None:
    """Return the SRDF beside a URDF that is for a robot of that name.

    An SRDF fits if it names that robot inside. If several files fit, or none does, the
    file names decide: of those with which the URDF's file name begins, the longest is
    taken.
    """
    found: list[Path] = []
    for directory in (urdf_path.parent, urdf_path.parent.parent / "srdf"):
        found += sorted(directory.glob("*.srdf"))
    by_file = [path for path in found if urdf_path.stem.startswith(path.stem)]
    by_name = [path for path in found if robot and _robot_name(path) == robot]
    candidates = [path for path in by_name if path in by_file] or by_name or by_file
    return max(candidates, key=lambda path: len(path.stem), default=None)


def _robot_name(srdf_path: Path) -> str:
    """Return the robot's name in an SRDF; empty if the file cannot be read."""
    try:
        return parse_robot(srdf_path.read_text(encoding="utf-8")).get("name", "")
    except (OSError, RobotDescriptionError, UnicodeDecodeError):
        return ""  # if it is chosen by its file name, its reader reports the reason


def _package_roots(urdf_path: Path) -> list[Path]:
    roots = list(urdf_path.resolve().parents)
    roots += [Path(p) for p in os.environ.get("ROS_PACKAGE_PATH", "").split(":") if p]
    return roots + [directory.parent for directory in data_directories()]


def _how_to_install_robots() -> str:
    return (
        f"Install all its robots (430 MB): {install_command('robots')}. Or give the "
        "path of a URDF."
    )
