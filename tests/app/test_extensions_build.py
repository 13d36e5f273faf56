"""A station that runs interpreted has its extensions built beside it."""

import pytest

from station import compiled
from station.app.extensions_build import ExtensionsBuild
from station.compiled import CompilationStatus

INTERPRETED = CompilationStatus("interpreted", "There are no compiled extensions.")
BUILDING = CompilationStatus("interpreted", "They are being built.")


@pytest.fixture
def machine(monkeypatch):
    """Return a machine on which extensions are missing and can be built."""

    class Machine:
        needs_building = True
        is_being_built = False
        failure = ""
        builds = 0

        def build(self):
            self.builds += 1
            self.is_being_built = True

    machine = Machine()
    for name, answer in {
        "needs_building": lambda: machine.needs_building,
        "present_status": lambda: BUILDING if machine.is_being_built else INTERPRETED,
        "is_being_built": lambda: machine.is_being_built,
        "find_failure": lambda: machine.failure,
        "build_in_background": machine.build,
    }.items():
        monkeypatch.setattr(compiled, name, answer)
    return machine


@pytest.fixture
def warnings():
    """Return the list that the build warns into."""
    return []


def test_missing_extensions_are_built_in_the_background(machine, warnings):
    build = ExtensionsBuild(warnings.append)

    assert build.start() == BUILDING.text()

    assert machine.builds == 1
    assert not build.is_settled()
    machine.is_being_built = False
    assert build.is_settled()
    assert warnings == []


def test_nothing_is_built_where_nothing_is_missing(machine, warnings):
    machine.needs_building = False
    build = ExtensionsBuild(warnings.append)

    assert build.start() == INTERPRETED.text()

    assert machine.builds == 0
    assert build.is_settled()


def test_a_build_that_fails_is_a_warning(machine, warnings):
    build = ExtensionsBuild(warnings.append)
    build.start()

    machine.failure = "gcc: out of luck."

    assert build.is_settled()
    assert warnings == ["The extensions could not be built: gcc: out of luck."]


@pytest.mark.usefixtures("machine")
@pytest.mark.parametrize("error", [OSError("no memory"), BlockingIOError("locked")])
def test_a_build_that_cannot_start_is_a_warning(monkeypatch, warnings, error):
    def build():
        raise error

    monkeypatch.setattr(compiled, "build_in_background", build)

    assert ExtensionsBuild(warnings.append).start() == INTERPRETED.text()
    (warning,) = warnings
    assert warning.startswith("The extensions cannot be built: ")
