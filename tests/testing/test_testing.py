"""The names of the testing kit, and what it imports."""

import subprocess
import sys

import pytest

import station.testing

NAMES = (
    *("ArmConformance", "ControllerConformance", "RobotConformance"),
    *("Bench", "HookScript", "RecordedBehaviour", "ScriptedBench"),
    *("StormReport", "SwitchObserver", "storm"),
)


@pytest.mark.parametrize("name", NAMES)
def test_every_name_can_be_imported(name):
    assert callable(getattr(station.testing, name))


def test_an_unknown_name_is_refused():
    with pytest.raises(AttributeError, match="no attribute 'Nothing'"):
        station.testing.Nothing  # noqa: B018 - asking is the test


def test_a_suite_without_pytest_says_what_to_install(monkeypatch):
    monkeypatch.setattr(station.testing, "find_spec", lambda _: None)

    with pytest.raises(ModuleNotFoundError, match="pip install pytest"):
        station.testing.RobotConformance  # noqa: B018 - asking is the test


def test_the_storm_and_the_bench_need_no_pytest():
    code = "import sys, station.testing; sys.exit('pytest' in sys.modules)"

    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
