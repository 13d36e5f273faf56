"""The direction of imports holds, and the check that says so can fail."""

import os
import subprocess
import sys
import tomllib
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
    "events-watch-the-core": ("station/events/event.py", "import fastapi"),
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


@pytest.mark.parametrize(
    "line",
    [
        "import mujoco",
        "import station.hw.mujoco",
        "import station.hw.franka.simulated",
        "import station.core.franka.joint_memory",
    ],
)
@pytest.mark.parametrize("room", ["arm", "commands", "hand"])
def test_no_simulation_is_seen_from_before_the_seam(room, line, tmp_path):
    newcomer = {f"station/hw/franka/{room}/newcomer.py": line}
    write_example(tmp_path, {**PERMITTED, **newcomer})

    result = check_contracts(tmp_path, only=("franka-seam",))

    assert "0 kept, 1 broken" in result.stdout


@pytest.mark.parametrize("contract", VIOLATIONS)
def test_contract_breaks_on_a_violation(contract, tmp_path):
    name, line = VIOLATIONS[contract]
    write_example(tmp_path, {**PERMITTED, name: line})

    result = check_contracts(tmp_path, only=(contract,))

    assert result.returncode == 1, result.stdout + result.stderr
    assert "0 kept, 1 broken" in result.stdout


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
