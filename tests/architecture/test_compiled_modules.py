"""A compiled module imports compiled modules alone: no web, no logging, no NumPy."""

import ast
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# Types, errors and memory, which any module may use.
PERMITTED = ("station.core.errors", "station.memory", "station.compiled", "cython")
# Of the standard library, what waits, writes or starts something.
REFUSED = {"asyncio", "logging", "multiprocessing", "socket", "subprocess"}
# A class that every cycle calls is in one file with its parameters and its reports, for
# which these modules import modules of the station that are not compiled. All they
# import besides is this.
WITH_REPORTS = {
    "station.controllers.cartesian_motion.cartesian_motion_controller",
    "station.controllers.cartesian_motion.joint_lookahead",
    "station.controllers.franka_arm.cartesian_spring",
    "station.controllers.joint_trajectory_controller.execution",
    "station.controllers.set_point_controller",
    "station.core.control.command_gate",
    "station.core.control.controller_update",
    "station.core.control.loaded_controller",
    "station.core.loop.control_cycle",
    "station.core.loop.snapshot",
    "station.core.numerics.durations",
    "station.core.numerics.pid",
    "station.core.ports.set_point",
    "station.hw.franka.simulated.accelerometers",
    "station.hw.franka.simulated.arm_step",
    "station.hw.franka.simulated.joint_watch",
    "station.hw.franka.simulated.motion_check",
    "station.hw.franka.simulated.violations",
}
# Smooth motions are computed by a library, of which one module knows.
PERMITTED_FOR = {"station.controllers.smoothed_motion.motion_generator": ("ruckig",)}
FOR_REPORTS = ("station", "numpy", "typing_extensions")

TYPES = "from typing import TYPE_CHECKING\nif TYPE_CHECKING:"


def module_name(source: Path, root: Path) -> str:
    return ".".join(source.relative_to(root).with_suffix("").parts)


def run_time_imports(tree: ast.AST, modules: set[str]) -> Iterator[str]:
    """Return the names of what is imported outside of `if TYPE_CHECKING`."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            for other in node.orelse:
                yield from run_time_imports(other, modules)
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            for alias in node.names:
                name = f"{node.module}.{alias.name}"
                yield name if name in modules else str(node.module)
        else:
            yield from run_time_imports(node, modules)


def is_permitted(name: str, importer: str, compiled: set[str]) -> bool:
    top = name.partition(".")[0]
    if top in sys.stdlib_module_names:
        return top not in REFUSED
    permitted = FOR_REPORTS if importer in WITH_REPORTS else PERMITTED
    permitted += PERMITTED_FOR.get(importer, ())
    return name in compiled or any(
        name == one or name.startswith(f"{one}.") for one in (*PERMITTED, *permitted)
    )


def violations(root: Path) -> list[str]:
    """Return every import of a compiled module below `root` that is not permitted."""
    package = root / "station"
    modules = {module_name(source, root) for source in package.rglob("*.py")}
    compiled = {module_name(types, root) for types in package.rglob("*.pxd")}
    return [
        f"{name} imports {imported}"
        for name in sorted(compiled)
        for imported in run_time_imports(
            ast.parse((root / f"{name.replace('.', '/')}.py").read_text()), modules
        )
        if not is_permitted(imported, name, compiled)
    ]


def test_compiled_modules_import_compiled_modules_alone():
    assert violations(ROOT) == []


@pytest.mark.parametrize(
    ("line", "is_refused"),
    [
        ("import numpy as np", True),
        ("import logging", True),
        ("from station.plain import thing", True),
        ("def f():\n    from station.plain import thing", True),
        ("from station import plain", True),
        ("from station.fast import thing", False),
        ("from station.core.errors import StationError", False),
        ("from math import sqrt", False),
        (
            "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import numpy",
            False,
        ),
    ],
)
def test_a_violation_is_found(tmp_path, line, is_refused):
    package = tmp_path / "station"
    package.mkdir()
    for name in ("fast", "plain", "tried"):
        (package / f"{name}.py").write_text(f"{line}\n" if name == "tried" else "")
    for name in ("fast", "tried"):
        (package / f"{name}.pxd").touch()

    assert bool(violations(tmp_path)) is is_refused
