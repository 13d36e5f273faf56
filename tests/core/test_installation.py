"""Which extra is missing, and the command that installs it here."""

import importlib.metadata
import json
import sys
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from station.core.errors import StationError
from station.core.installation import EXTRAS, install_command, missing_extra

ROOT = Path(__file__).parents[2]


@pytest.fixture
def installed_from(monkeypatch):
    """Return a way to say where this station was installed from."""

    def install(origin):
        class Distribution:
            def read_text(self, name):
                assert name == "direct_url.json"
                return None if origin is None else json.dumps(origin)

        monkeypatch.setattr(
            importlib.metadata, "distribution", lambda _: Distribution()
        )

    return install


@pytest.mark.parametrize(
    ("origin", "command"),
    [
        (
            {
                "url": "https://host/station.git",
                "vcs_info": {"vcs": "git", "commit_id": "abc"},
            },
            "pip install 'control-station[sim] @ git+https://host/station.git@abc'",
        ),
        (
            {"url": "file:///x/control_station-0.1.0-py3-none-any.whl"},
            "pip install 'control-station[sim] @ "
            "file:///x/control_station-0.1.0-py3-none-any.whl'",
        ),
        (
            {"url": "file:///my%20home/station", "dir_info": {"editable": True}},
            "pip install -e '/my home/station[sim]'",
        ),
        (
            {"url": "file:///home/me/station", "dir_info": {}},
            "pip install 'control-station[sim] @ file:///home/me/station'",
        ),
    ],
)
def test_the_command_names_where_the_station_came_from(installed_from, origin, command):
    installed_from(origin)
    assert install_command("sim") == command


def test_a_clone_with_an_environment_of_its_own_is_set_up_by_make(
    installed_from, monkeypatch
):
    installed_from({"url": "file:///home/me/station", "dir_info": {"editable": True}})
    monkeypatch.setattr(sys, "prefix", "/home/me/station/.venv")
    assert install_command("sim") == "make -C /home/me/station setup"


def test_a_source_on_the_path_is_a_clone(installed_from):
    installed_from(None)
    assert f"{ROOT}" in install_command("sim")


def test_a_missing_package_names_its_extra_and_the_command():
    error = missing_extra(ModuleNotFoundError("No module", name="mujoco.viewer"))

    assert isinstance(error, StationError)
    assert isinstance(error, ModuleNotFoundError)
    assert "'mujoco' is not installed; control-station brings it" in error.message
    assert install_command("sim") in error.remedy
    assert error.remedy in str(error)
    assert missing_extra(ModuleNotFoundError("No module", name="elsewhere")) is None
    assert missing_extra(ImportError("cannot import name", name="mujoco")) is None


def _packages(extras: dict[str, list[str]], extra: str) -> set[str]:
    """Return what an extra brings, directly and by other extras of this project."""
    found: set[str] = set()
    for line in extras[extra]:
        required = Requirement(line)
        if required.name == "control-station":
            found = found.union(*(_packages(extras, one) for one in required.extras))
        else:
            # foxglove-sdk brings the package foxglove.
            package = required.name.removesuffix("-sdk").replace("-", "_")
            found.add("PIL" if package == "pillow" else package)
    return found


def test_extras_bring_the_packages_that_are_said_to_be_theirs():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = settings["optional-dependencies"]
    brought = {extra: _packages(extras, extra) for extra in extras}
    parts = {"lxml", "networkx", "prometheus_client", "pycollada"}

    assert all(p in brought[e] for p, names in EXTRAS.items() for e in names)
    assert set().union(*brought.values()) - set(EXTRAS) - parts == {
        "example_robot_data"
    }


def test_the_client_needs_neither_numpy_nor_cython():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    names = {Requirement(line).name for line in settings["dependencies"]}
    assert names.isdisjoint({"numpy", "cython", "mujoco"})
