"""A station starts in order, tells where it is, and stops in reverse order.

A station that runs interpreted has its extensions built beside it.
"""

import http.client
import json
import os
import signal
import socket
import sys
from urllib.parse import urlsplit

import pytest

from station import compiled
from station.api.server import ApiServer
from station.app import lifecycle
from station.app.lifecycle import ExtensionsBuild, StationRun
from station.app.restart_limit import MOST_RESTARTS
from station.app.ui_process import UiOptions
from station.client import StationClient
from station.compiled import CompilationStatus
from station.config import load_config
from station.config.models import TlsSection
from station.core.errors import StationError
from station.local.station_locator import find_running
from station.local.tls import TlsFilesError
from tests.app.mass_hw import BROKEN_TYPE, TYPE
from tests.certificates import make_certificate

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
    """Keeps what the station tells, and ends the station at a word of choice.

    Args:
        until: `api`, `dashboard`, or a part of the warning that ends it.
        when_running: Called with the announcement once the API answers.
    """

    def __init__(self, until="api", when_running=lambda _: None):
        self.announcements = []
        self.warnings = []
        self._until = until
        self._when_running = when_running

    def tell(self, announcement):
        self.announcements.append(announcement)
        try:
            self._when_running(announcement)
        finally:
            self._end(self._until == "api")

    def tell_dashboard(self, _):
        self._end(self._until == "dashboard")

    def warn(self, line):
        self.warnings.append(line)
        self._end(self._until in line)

    def _end(self, condition):
        if condition:
            os.kill(os.getpid(), signal.SIGTERM)

    def run(self, config):
        StationRun(
            config,
            tell=self.tell,
            tell_dashboard=self.tell_dashboard,
            warn=self.warn,
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
    listener = Listener(when_running=lambda a: answers.append(fetch(a, "controllers")))

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
    def interrupted(_, **__):
        os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr("station.app.lifecycle.compose", interrupted)
    listener = Listener()

    listener.run(config)

    assert listener.announcements == []


def test_robot_is_held_before_streams_close(config, monkeypatch):
    stations, states = [], []

    def compose(given, **options):
        composition = lifecycle_compose(given, **options)
        stations.append(composition.station)
        return composition

    def stop(server, timeout):
        states.extend(c.state.value for c in stations[0].controllers())
        server_stop(server, timeout)

    lifecycle_compose, server_stop = lifecycle.compose, ApiServer.stop
    monkeypatch.setattr(lifecycle, "compose", compose)
    monkeypatch.setattr(ApiServer, "stop", stop)

    Listener().run(config)

    assert states == ["stopped"]


def test_refused_realtime_is_told(config, monkeypatch):
    monkeypatch.setattr(
        "station.core.loop.control_loop.request_realtime_priority",
        lambda: "SCHED_OTHER",
    )
    listener = Listener(until="SCHED_OTHER")

    listener.run(config)

    assert any("SCHED_OTHER" in warning for warning in listener.warnings)


def test_death_of_the_loop_is_told(config):
    robot = config.robot.model_copy(update={"type": BROKEN_TYPE})
    listener = Listener(until="the cable is out")

    listener.run(config.model_copy(update={"robot": robot}))

    assert find_running() == []


@pytest.fixture
def config_with_ui(config):
    """Return the configuration of a station with a dashboard."""
    ui = config.ui.model_copy(update={"enabled": True, "port": 0})
    return config.model_copy(update={"ui": ui})


def test_dashboard_is_told_when_it_answers(config_with_ui, monkeypatch):
    serve = [sys.executable, "-m", "http.server", "--bind", "127.0.0.1"]
    monkeypatch.setattr(UiOptions, "command", lambda ui: [*serve, str(ui.port)])
    listener = Listener(until="dashboard")

    listener.run(config_with_ui)

    assert listener.announcements[0].ui_url.startswith("http://127.0.0.1:")
    assert not [w for w in listener.warnings if "dashboard" in w]


def test_end_of_the_dashboard_is_told(config_with_ui, monkeypatch):
    fail = [sys.executable, "-c", "import sys; sys.exit(3)"]
    monkeypatch.setattr(UiOptions, "command", lambda _: fail)
    listener = Listener(until="station ui --connect")

    listener.run(config_with_ui)

    again = [w for w in listener.warnings if "it is started again" in w]
    assert len(again) == MOST_RESTARTS
    assert "The dashboard ended (exit code 3)" in listener.warnings[-1]


def test_a_killed_dashboard_is_started_again_at_its_port(
    config_with_ui, monkeypatch, tmp_path
):
    was_there = tmp_path / "was-there"
    die_once = (
        "import os, pathlib, runpy, sys\n"
        f"was_there = pathlib.Path({str(was_there)!r})\n"
        "if was_there.exists():\n"
        "    runpy.run_module('http.server', run_name='__main__')\n"
        "was_there.touch()\n"
        "os.kill(os.getpid(), 9)\n"
    )
    ports = []

    def command(options):
        ports.append(options.port)
        serve = [sys.executable, "-c", die_once, "--bind", "127.0.0.1"]
        return [*serve, str(options.port)]

    monkeypatch.setattr(UiOptions, "command", command)
    listener = Listener(until="station ui --connect")
    listener.tell_dashboard = lambda _: os.kill(os.getpid(), signal.SIGTERM)

    listener.run(config_with_ui)

    (warning,) = [w for w in listener.warnings if "dashboard" in w]
    assert "(exit code -9); it is started again at the same address" in warning
    assert listener.announcements[0].ui_url.endswith(f":{ports[0]}")


def with_tls(config, certificate, key):
    tls = TlsSection(certificate=str(certificate), key=str(key))
    api = config.api.model_copy(update={"tls": tls})
    return config.model_copy(update={"api": api})


def test_with_tls_programs_of_the_user_find_and_trust_the_station(
    config, tmp_path, monkeypatch
):
    for variable in ("STATION_URL", "STATION_TOKEN", "STATION_CA"):
        monkeypatch.delenv(variable, raising=False)
    files = make_certificate(tmp_path, names="DNS:robot.example")
    modes = []

    def ask(_):
        with StationClient() as client:
            modes.append((client.url, client.ready().ready))

    listener = Listener(when_running=ask)
    listener.run(with_tls(config, files.certificate, files.key))

    assert listener.announcements[0].api_url.startswith("https://127.0.0.1:")
    assert modes == [(listener.announcements[0].api_url, modes[0][1])]


def test_the_dashboard_of_a_station_with_tls_speaks_plain_http():
    assert lifecycle._dashboard_url("https://[::1]:8000", 8080) == "http://[::1]:8080"


def test_a_certificate_that_cannot_be_used_is_told_before_anything_starts(
    config, tmp_path
):
    listener = Listener()
    with pytest.raises(TlsFilesError, match=r"none\.crt cannot be read"):
        listener.run(with_tls(config, tmp_path / "none.crt", tmp_path / "none.key"))

    assert listener.announcements == []


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
