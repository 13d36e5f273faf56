"""The shared library with the model of an arm, which libfranka loads.

libfranka has no model of its own: it asks the robot for a library with functions of
fixed names. The station writes the numbers of its arm in front of `model_library.c` and
compiles both where there is a C compiler; the result is kept, named after its source.
"""

import hashlib
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from station.core.description.robot_files import RobotFiles
from station.core.errors import StationError
from station.core.scheduling import ordinary_priority
from station.hw.franka.arm.franka_kinematics import CHAIN, DOF
from station.hw.franka.fci.wire.robot_protocol import Architecture, System
from station.hw.franka.simulated.franka_dynamics import read_bodies

COMPILERS = ("cc", "gcc", "clang")
"""Names under which a C compiler is looked for."""
_TEMPLATE = Path(__file__).with_name("model_library.c")
_OPTIONS = ("-O2", "-shared", "-fPIC", "-std=c99")
_ARCHITECTURES = {
    "x86_64": Architecture.X64,
    "i686": Architecture.X86,
    "armv7l": Architecture.ARM,
    "aarch64": Architecture.ARM64,
}
_UNKNOWN = -1
_LONGEST_COMPILATION = 60.0


class ModelLibraryError(StationError):
    """The model library of an arm cannot be made."""

    code = "fci_model_library"


def build_model_library(description: RobotFiles) -> dict[tuple[int, int], bytes]:
    """Return the model library of an arm, compiled now unless it was before.

    Args:
        description: The URDF of a Franka arm.

    Returns:
        The library by the `Architecture` and the `System` of this machine; nothing for
        other machines.

    Raises:
        ModelLibraryError: There is no C compiler, or it fails.
        RobotDescriptionError: The URDF does not describe a Franka arm.
    """
    source = model_source(description)
    kept = _kept(source)
    if not kept.is_file():
        _compile(source, kept)
    own = _ARCHITECTURES.get(platform.machine(), _UNKNOWN)
    return {(own, System.LINUX): kept.read_bytes()} if sys.platform == "linux" else {}


def model_source(description: RobotFiles) -> str:
    """Return the C source of the model of an arm.

    Args:
        description: The URDF of a Franka arm.

    Raises:
        RobotDescriptionError: The URDF does not describe a Franka arm.
    """
    bodies = np.reshape(read_bodies(description), (DOF, -1)).tolist()
    masses: list[float] = []
    centers: list[Sequence[float]] = []
    inertias: list[Sequence[float]] = []
    for mass, *first, xx, yy, zz, xy, xz, yz in bodies:
        center = np.array(first) / (mass or 1.0)
        second = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        second -= mass * np.outer(center, center)
        inertia = np.trace(second) * np.eye(3) - second
        masses.append(mass)
        centers.append(center.tolist())
        inertias.append(inertia.ravel().tolist())
    chain = [CHAIN[start : start + 4].tolist() for start in range(0, len(CHAIN), 4)]
    numbers = (
        f"static const double CHAIN[{DOF + 1}][4] = {_rows(chain)};\n"
        f"static const double MASS[{DOF}] = {_row(masses)};\n"
        f"static const double CENTER[{DOF}][3] = {_rows(centers)};\n"
        f"static const double INERTIA[{DOF}][9] = {_rows(inertias)};\n"
    )
    return numbers + _TEMPLATE.read_text(encoding="utf-8")


def _rows(rows: Iterable[Sequence[float]]) -> str:
    return "{" + ",\n".join(_row(row) for row in rows) + "}"


def _row(values: Iterable[float]) -> str:
    return "{" + ", ".join(repr(value) for value in values) + "}"


def _kept(source: str) -> Path:
    cache = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    identity = "\n".join((platform.machine(), *_OPTIONS, source))
    digest = hashlib.sha256(identity.encode()).hexdigest()[:16]
    return Path(cache) / "control-station" / "fci" / f"model-{digest}.so"


def _compile(source: str, target: Path) -> None:
    compiler = next((c for c in COMPILERS if shutil.which(c)), None)
    if compiler is None:
        raise ModelLibraryError(
            "There is no C compiler to compile the model of the arm with; looked for "
            f"were {', '.join(COMPILERS)}.",
            remedy="Install one, e.g. Debian's gcc; clients that ask for no model can "
            "do without.",
        )
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=target.parent) as folder:
            text, built = Path(folder) / "model.c", Path(folder) / "model.so"
            text.write_text(source, encoding="utf-8")
            command = [compiler, *_OPTIONS, "-o", str(built), str(text), "-lm"]
            with ordinary_priority():
                subprocess.run(
                    command,
                    check=True,
                    capture_output=True,
                    text=True,
                    timeout=_LONGEST_COMPILATION,
                )
            built.replace(target)
    except (OSError, subprocess.SubprocessError) as error:
        said = getattr(error, "stderr", None) or str(error)
        raise ModelLibraryError(
            f"The model of the arm cannot be compiled: {said.strip()}",
            remedy="Repair the C compiler; clients that ask for no model can do "
            "without.",
        ) from error
