"""The station at a glance."""

from station.api.routes.status import versions
from station.compiled import present_status
from station.core.control.controller_manager import ControllerManager
from station.wire import CommandViolations


def test_status(client, station):
    status = client.status()

    assert status.boot_id == station.boot_id
    assert status.cycle == 1
    assert status.stop_state == "armed"
    assert status.robot_type == "test/OneJointHW"
    assert status.loop.state == "stopped"
    assert status.versions["station"]


def test_status_says_which_kernel_runs_and_why(client):
    kernel = client.status().kernel

    assert (kernel.mode, kernel.reason) == (
        present_status().mode,
        present_status().reason,
    )


def test_a_package_that_is_missing_does_no_harm(monkeypatch):
    from importlib.metadata import PackageNotFoundError

    from station.api.routes import status

    def missing(name):
        raise PackageNotFoundError(name)

    versions.cache_clear()
    monkeypatch.setattr(status, "version", missing)
    assert versions()["mujoco"] == "not installed"
    versions.cache_clear()


def test_commands_that_nobody_had_the_right_to_write_are_told(client, monkeypatch):
    assert client.status().command_violations == CommandViolations(count=0, last="")
    violations = (2, "'arm' wrote 5.0 to 'j', which it has not claimed")
    monkeypatch.setattr(
        ControllerManager, "command_violations", property(lambda _: violations)
    )

    told = client.status().command_violations

    assert (told.count, told.last) == violations
