"""The direction of imports holds, and the check that says so can fail."""

import os
import subprocess
import sys
import tomllib
from collections.abc import Sequence
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

# Every contract of pyproject.toml, each with an import that must break it.
VIOLATIONS = {
    "layers": ("station/core/clock.py", "import station.hw.mock"),
    "core-layers": ("station/core/errors.py", "import station.core.parameters"),
    "controller-families": (
        "station/controllers/effort_controllers.py",
        "import station.controllers.position_controllers",
    ),
    "franka-rooms": (
        "station/hw/franka/commands/arm_services.py",
        "import station.hw.franka.franka_parameters",
    ),
    "franka-seam": ("station/hw/franka/arm/robot_arm.py", "import station.hw.mujoco"),
    "memory-stands-alone": (
        "station/memory/functions.py",
        "import typing_extensions",
    ),
    "agents-seat-is-a-client": ("station/mcp/server.py", "import station.core"),
    "reports-stand-alone": ("station/reports.py", "import pydantic"),
    "core-is-ros-control-alone": ("station/core/clock.py", "import mujoco"),
    "controllers-see-core-alone": (
        "station/controllers/effort_controllers.py",
        "import pydantic",
    ),
    "testing-drives-the-core": ("station/testing/bench.py", "import pytest"),
    "wire-stands-alone": ("station/wire/base.py", "import station.core.errors"),
    "client-speaks-the-wire": ("station/client/sync.py", "import station.core"),
    "api-serves": ("station/api/app.py", "import viser"),
    "web-stands-alone": ("station/web/limited_server.py", "import station.core"),
    "records-read-the-core": ("station/records/cdr.py", "import fastapi"),
    "trials-are-data": ("station/trials/trial.py", "import mujoco"),
    "experiments-run-in-process": (
        "station/experiments/runner.py",
        "import station.api.app",
    ),
    "events-watch-the-core": ("station/events/event_file.py", "import fastapi"),
    "ui-rooms": ("station/ui/scene/robot_scene.py", "import station.ui.page"),
    "ui-is-a-client": ("station/ui/dashboard.py", "import station.core.clock"),
}

# What the contracts are there to permit.
PERMITTED = {
    "station/__main__.py": "import station.cli",
    "station/api/app.py": "import fastapi, station, station.wire",
    "station/wire/base.py": "import pydantic",
    "station/app.py": "import station.api.app, station.hw.mock, station.config",
    "station/cli.py": "import station.app, station.client.sync",
    "station/client/sync.py": "import httpx, json, station.wire",
    "station/config.py": "import pydantic, station.core.errors",
    "station/controllers/effort_controllers.py": "import numpy, station.core.clock",
    "station/controllers/position_controllers.py": "import station.core.clock",
    "station/core/clock.py": "import time, station.core.errors",
    "station/core/description/urdf.py": "import xml.etree, station.core.errors",
    "station/core/parameters.py": "import station.core.errors",
    "station/core/errors.py": "import enum, station.reports",
    "station/reports.py": "import dataclasses",
    "station/core/franka/joint_memory.py": "import station.core.errors",
    "station/hw/franka/arm/robot_arm.py": "import station.core.clock",
    "station/hw/franka/commands/arm_services.py": "import station.hw.franka.arm",
    "station/hw/franka/franka_hw.py": "import station.hw.franka.simulated",
    "station/hw/franka/franka_parameters.py": "import station.hw.franka.commands",
    "station/hw/franka/hand/hand_services.py": "import station.core.clock",
    "station/hw/franka/simulated/simulated_arm.py": "import mujoco, station.hw.mujoco",
    "station/memory/functions.py": "import cython, math",
    "station/hw/mock.py": "import mujoco, station.core.clock",
    "station/hw/mujoco/world.py": "import mujoco",
    "station/trials/trial.py": "import numpy, station.config, station.wire",
    "station/experiments/runner.py": "import mujoco, station.trials.trial",
    "station/testing/bench.py": "import station.core.clock, station.hw.mock",
    "station/testing/conformance/robot_conformance.py": "import pytest",
    "station/ui/dashboard.py": "import viser, station.client.sync, station.wire",
    "station/ui/page.py": "import station.ui.scene.robot_scene",
    "station/ui/scene/robot_scene.py": "import yourdfpy, station.core.description.urdf",
}

# Packages and modules that must stay light when imported, and what they must not load.
LIGHT = {
    "station.core": {"fastapi", "mujoco", "pydantic", "uvicorn", "viser"},
    "station.controllers": {"fastapi", "mujoco", "pydantic", "uvicorn", "viser"},
    "station.client": {"fastapi", "mujoco", "numpy", "uvicorn", "viser"},
    "station.hw.franka.franka_hw": {"fastapi", "mujoco", "uvicorn", "viser"},
}


def contract_ids() -> list[str]:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    return [c["id"] for c in settings["tool"]["importlinter"]["contracts"]]


def run_python(code: str, *, directory: Path) -> subprocess.CompletedProcess[str]:
    path = os.pathsep.join([str(directory), str(ROOT)])
    return subprocess.run(
        [sys.executable, "-c", code],
        cwd=directory,
        env={**os.environ, "PYTHONPATH": path, "COLUMNS": "200", "NO_COLOR": "1"},
        capture_output=True,
        text=True,
        check=False,
    )


# A process for each folder, made by a fork: importing the linter takes longer than to
# check a small package.
CHECKS = """
import os, sys
from importlinter.cli import lint_imports
for folder, contract in {jobs}:
    if os.fork() == 0:
        output = os.open(folder + "/report", os.O_CREAT | os.O_WRONLY)
        os.dup2(output, 1)
        os.dup2(output, 2)
        os.chdir(folder)
        sys.path.insert(0, folder)
        passed = lint_imports({config!r}, (contract,), no_cache=True) == 0
        print("PASSED" if passed else "FAILED", flush=True)
        os._exit(0)
    os.wait()
"""


def check_contracts(
    directory: Path, *, only: tuple[str, ...] = ()
) -> subprocess.CompletedProcess[str]:
    options = {
        "config_filename": str(ROOT / "pyproject.toml"),
        "limit_to_contracts": only,
        "no_cache": True,
    }
    return run_python(
        "import sys; from importlinter.cli import lint_imports; "
        f"sys.exit(lint_imports(**{options!r}))",
        directory=directory,
    )


def kept_in_spite_of(
    directory: Path, examples: Sequence[tuple[str, str, str]]
) -> list[str]:
    """Return the reports of the contracts that do not break on an import.

    Args:
        directory: An empty folder for the examples.
        examples: Contract, module and line of each import that must break it.
    """
    jobs = []
    for number, (contract, name, line) in enumerate(examples):
        folder = directory / f"{number}"
        write_example(folder, {**PERMITTED, name: line})
        jobs.append((str(folder), contract))
    config = str(ROOT / "pyproject.toml")
    ran = run_python(CHECKS.format(jobs=jobs, config=config), directory=directory)
    assert ran.returncode == 0, ran.stderr
    reports = [Path(folder, "report").read_text() for folder, _ in jobs]
    return [
        f"{example}: {report}"
        for example, report in zip(examples, reports, strict=True)
        if "0 kept, 1 broken" not in report or not report.endswith("FAILED\n")
    ]


def write_example(directory: Path, files: dict[str, str]) -> None:
    """Write a small package `station` whose modules hold one line each."""
    for name, line in files.items():
        module = directory / name
        module.parent.mkdir(parents=True, exist_ok=True)
        module.write_text(f"{line}\n")
    for package in {(directory / name).parent for name in files}:
        (package / "__init__.py").touch()


def test_contracts_hold():
    result = check_contracts(ROOT)

    assert result.returncode == 0, result.stdout + result.stderr
    assert f"{len(contract_ids())} kept, 0 broken" in result.stdout


def test_contracts_permit_the_drawn_architecture(tmp_path):
    write_example(tmp_path, PERMITTED)

    result = check_contracts(tmp_path)

    assert result.returncode == 0, result.stdout + result.stderr


def test_every_contract_has_a_violation_to_try():
    assert set(VIOLATIONS) == set(contract_ids())


def test_no_simulation_is_seen_from_before_the_seam(tmp_path):
    examples = [
        ("franka-seam", f"station/hw/franka/{room}/newcomer.py", f"import {name}")
        for room in ("arm", "commands", "hand")
        for name in (
            "mujoco",
            "station.hw.mujoco",
            "station.hw.franka.simulated",
            "station.core.franka.joint_memory",
        )
    ]

    assert kept_in_spite_of(tmp_path, examples) == []


def test_every_contract_breaks_on_its_violation(tmp_path):
    examples = [(contract, *where) for contract, where in VIOLATIONS.items()]

    assert kept_in_spite_of(tmp_path, examples) == []


def test_a_contract_that_does_not_break_is_found(tmp_path):
    name, line = VIOLATIONS["layers"]

    (found,) = kept_in_spite_of(tmp_path, [("layers", name, "import enum")])

    assert "1 kept, 0 broken" in found
    assert line not in found


def test_layers_break_on_a_package_that_nobody_ranked(tmp_path):
    write_example(tmp_path, {**PERMITTED, "station/newcomer/thing.py": ""})

    result = check_contracts(tmp_path, only=("layers",))

    assert result.returncode == 1, result.stdout + result.stderr
    assert "newcomer" in result.stdout


@pytest.mark.parametrize("package", LIGHT)
def test_package_stays_light_when_imported(package):
    result = run_python(
        f"import sys, {package}; print(*sorted(set(sys.modules) & {LIGHT[package]!r}))",
        directory=ROOT,
    )

    assert result.returncode == 0, result.stderr
    assert not result.stdout.strip(), f"importing {package} also loads {result.stdout}"


def test_franka_with_a_given_arm_runs_without_a_simulator():
    code = """
import sys
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.franka_hw import FrankaHW
from tests.hw.franka.scripted_arm import ScriptedArm

robot = {"arm_id": "panda", "robot_description": "example-robot-data:panda"}
tree = ParameterTree({"robot": robot})
hw = FrankaHW(ScriptedArm())
hw.init(Parameters(tree), Parameters(tree, "robot"))
hw.read(0.001, 0.001)
hw.write(0.001, 0.001)
print(hw.mode(), hw.simulated_world(), "mujoco" in sys.modules)
"""
    result = run_python(code, directory=ROOT)

    assert result.stdout.split() == ["idle", "None", "False"], result.stderr
