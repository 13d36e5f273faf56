"""A station starts in order, tells where it is, and stops in reverse order."""

import http.client
import json
import os
import signal
import socket
from urllib.parse import urlsplit

import pytest

from station.app.lifecycle import StationRun
from station.app.runtime_file import find_running
from station.config import load_config
from station.core.errors import StationError
from tests.app.mass_hw import TYPE

CONTROLLERS = (
    "{arm: {type: position_controllers/JointGroupPositionController, "
    "joints: [joint1]}, odd: {type: no/Such}}"
)


@pytest.fixture(autouse=True)
def runtime(tmp_path, monkeypatch):
    """Let the runtime file be in a directory of the test."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))


@pytest.fixture
def config(tmp_path):
    """Return the configuration of a station without dashboard."""
    path = tmp_path / "station.yaml"
    path.write_text(
        f"robot: {{type: '{TYPE}'}}\ncontrollers: {CONTROLLERS}\nstart: [arm]\n"
        "api: {port: 0}\nui: {enabled: false}\nstation: {rate: 100}"
    )
    return load_config(path)


class Listener:
    """What the station tells, and what happens when it has told it."""

    def __init__(self, when_running=lambda _: None):
        self.announcements = []
        self.warnings = []
        self._when_running = when_running

    def tell(self, announcement):
        self.announcements.append(announcement)
        try:
            self._when_running(announcement)
        finally:
            os.kill(os.getpid(), signal.SIGTERM)

    def run(self, config):
        StationRun(
            config,
            tell=self.tell,
            tell_dashboard=self.tell,
            warn=self.warnings.append,
        ).run()


def fetch(announcement, path):
    (running,) = find_running()
    connection = http.client.HTTPConnection(urlsplit(announcement.api_url).netloc)
    headers = {"Authorization": f"Bearer {running.token}"}
    connection.request("GET", f"/api/v1/{path}", headers=headers)
    answer = json.loads(connection.getresponse().read())
    connection.close()
    return answer


def test_station_is_reachable_while_it_runs(config):
    answers = []
    listener = Listener(lambda a: answers.append(fetch(a, "controllers")))

    listener.run(config)

    (arm,) = answers[0]["controllers"]
    assert (arm["name"], arm["state"]) == ("arm", "running")


def test_runtime_file_is_gone_afterwards(config):
    listener = Listener()

    listener.run(config)

    assert find_running() == []
    assert not os.path.exists(listener.announcements[0].runtime_file)


def test_controller_that_is_left_out_is_told(config):
    listener = Listener()

    listener.run(config)

    assert any("'odd'" in w and "no/Such" in w for w in listener.warnings)


def test_taken_port_is_refused_and_everything_stopped(config):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        api = config.api.model_copy(update={"port": port})
        with pytest.raises(StationError, match=str(port)):
            Listener().run(config.model_copy(update={"api": api}))

    assert find_running() == []


def test_exposed_host_without_token_is_refused(config):
    api = config.api.model_copy(update={"host": "0.0.0.0"})

    with pytest.raises(StationError, match="token"):
        Listener().run(config.model_copy(update={"api": api}))


def test_signal_during_the_start_ends_it(config, monkeypatch):
    def interrupted(_):
        os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr("station.app.lifecycle.compose", interrupted)
    listener = Listener()

    listener.run(config)

    assert listener.announcements == []
