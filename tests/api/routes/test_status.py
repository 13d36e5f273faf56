"""The station at a glance."""

from station.api.routes.status import versions


def test_status(client, station):
    status = client.status()

    assert status.boot_id == station.boot_id
    assert status.cycle == 1
    assert status.stop_state == "armed"
    assert status.robot_type == "test/OneJointHW"
    assert status.loop.state == "stopped"
    assert status.versions["station"]


def test_a_package_that_is_missing_does_no_harm(monkeypatch):
    from importlib.metadata import PackageNotFoundError

    from station.api.routes import status

    def missing(name):
        raise PackageNotFoundError(name)

    versions.cache_clear()
    monkeypatch.setattr(status, "version", missing)
    assert versions()["mujoco"] == "not installed"
    versions.cache_clear()
