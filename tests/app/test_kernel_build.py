"""A station that runs interpreted has its kernel built beside it."""

import subprocess

import pytest

from station.app import kernel_build
from station.app.kernel_build import KernelBuild
from station.kernel import KernelStatus

INTERPRETED = KernelStatus("interpreted", "There is no compiled kernel.")


@pytest.fixture
def machine(monkeypatch):
    """Return a machine on which a kernel is missing and can be built."""

    class Machine:
        needs_building = True
        is_being_built = False
        failure = None

        def __init__(self):
            self.commands = []

        def run(self, command, **_):
            self.commands.append(command)
            self.is_being_built = True

    machine = Machine()
    monkeypatch.setattr(kernel_build, "STATUS", INTERPRETED)
    monkeypatch.setattr(
        kernel_build, "needs_building", lambda _: machine.needs_building
    )
    monkeypatch.setattr(
        kernel_build,
        "present_status",
        lambda status: (
            KernelStatus("interpreted", "It is being built.")
            if machine.is_being_built
            else status
        ),
    )
    monkeypatch.setattr(kernel_build, "is_being_built", lambda: machine.is_being_built)
    monkeypatch.setattr(kernel_build, "find_failure", lambda: machine.failure)
    monkeypatch.setattr(kernel_build.subprocess, "run", machine.run)
    return machine


@pytest.fixture
def warnings():
    """Return the list that the build warns into."""
    return []


def test_a_missing_kernel_is_built_in_the_background(machine, warnings):
    build = KernelBuild(warnings.append)

    assert build.start() == "interpreted: It is being built."

    (command,) = machine.commands
    assert command[1:] == ("-m", "station.kernel.build", "--background")
    assert not build.is_settled()
    machine.is_being_built = False
    assert build.is_settled()
    assert warnings == []


def test_nothing_is_built_where_nothing_is_missing(machine, warnings):
    machine.needs_building = False
    build = KernelBuild(warnings.append)

    assert build.start() == INTERPRETED.text()

    assert machine.commands == []
    assert build.is_settled()


def test_a_build_that_fails_is_a_warning(machine, warnings, tmp_path):
    build = KernelBuild(warnings.append)
    build.start()

    machine.failure = tmp_path / "a.failed"

    assert build.is_settled()
    assert warnings == [f"The kernel could not be built, see {machine.failure}."]


@pytest.mark.usefixtures("machine")
@pytest.mark.parametrize(
    "error", [OSError("no memory"), subprocess.CalledProcessError(1, "python")]
)
def test_a_build_that_cannot_start_is_a_warning(monkeypatch, warnings, error):
    def run(*_, **__):
        raise error

    monkeypatch.setattr(kernel_build.subprocess, "run", run)

    assert KernelBuild(warnings.append).start() == INTERPRETED.text()
    (warning,) = warnings
    assert warning.startswith("The kernel cannot be built: ")
