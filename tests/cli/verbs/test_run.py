"""Verbs `run`, `fci` and `fetch_robot`: options become configuration."""

import json
from pathlib import Path

import pytest

from station.app.addresses import Announcement
from station.app.fci_run import FciRun
from station.app.station_watchdog import EndedByWatchdogError
from station.cli import main
from station.cli.parser import parse
from station.hw.franka.fci.server.fci_server import FciCounts

pytestmark = pytest.mark.usefixtures("log_as_before")

ANNOUNCEMENT = Announcement(
    "http://a",
    "http://u",
    "secret",
    "/run/x",
    "SCHED_FIFO 50",
    "SIMULATION",
    "compiled: It fits.",
)


@pytest.fixture
def started(monkeypatch):
    """Return the list of configurations that stations were started with."""
    configs = []

    class FakeRun:
        def __init__(self, config, *, tell, tell_dashboard, warn):
            configs.append(config)
            self._tell = tell, tell_dashboard
            self._warn = warn

        def run(self):
            for tell in self._tell:
                tell(ANNOUNCEMENT)
            self._warn("something")

    monkeypatch.setattr("station.app.lifecycle.StationRun", FakeRun)
    return configs


def test_options_override_the_configuration(run, started, tmp_path):
    path = tmp_path / "station.yaml"
    path.write_text("station: {rate: 250}\napi: {port: 1}\nui: {port: 2}")

    run(f"run {path} --port 3 --host 127.0.0.2 --token secret-token")
    run("run --rate 500 --ui-port 0 --no-ui --real-time-factor 2")

    first, second = started
    assert (first.station.rate, first.api.port, first.ui.port) == (250.0, 3, 2)
    assert (first.api.host, first.api.token) == ("127.0.0.2", "secret-token")
    assert (second.station.rate, second.station.real_time_factor) == (500.0, 2.0)
    assert (second.ui.enabled, second.ui.port) == (False, 0)


def test_controller_files_are_added(run, started, tmp_path):
    path = tmp_path / "ros.yaml"
    path.write_text("panda: {arm: {type: a/B}}")

    run(f"run --controllers {path}")

    assert "arm" in started[0].controllers


def test_arguments_of_files_are_added(run, started):
    run("run --arg prefix:=left_ tf_prefix:= --no-ui --port 0")

    assert started[0].arguments == {"prefix": "left_", "tf_prefix": ""}


@pytest.mark.parametrize("word", ["prefix", "prefix=left_", ":=left_"])
def test_a_malformed_argument_of_files_is_refused(run, started, word):
    outcome = run(f"run --arg {word} --no-ui --port 0")

    assert (outcome.code, started) == (2, [])
    assert f"'{word}' is not NAME:=VALUE, such as prefix:=left_" in outcome.err


@pytest.mark.usefixtures("started")
def test_addresses_are_printed(run):
    outcome = run("run")

    assert outcome.code == 0
    assert [line.split()[0] for line in outcome.out.splitlines()] == [
        "API",
        "Token",
        "Robot",
        "Cycle",
        "Dashboard",
    ]
    assert outcome.err == "warning: something\n"


@pytest.mark.usefixtures("started")
def test_addresses_can_be_json(run):
    first, second = map(json.loads, run("run --json").out.splitlines())

    assert first["api_url"] == "http://a"
    assert second == {"ui_ready": "http://u"}


@pytest.mark.parametrize("line", ["run --rate -5", "run no-such-file.yaml"])
def test_wrong_configuration_is_refused(run, started, line):
    outcome = run(line)

    assert outcome.code == 1
    assert outcome.err.startswith("error: ")
    assert started == []


def test_a_station_that_the_watchdog_ended_has_an_exit_code_of_its_own(
    run, monkeypatch
):
    class EndedRun:
        def __init__(self, *_, **__):
            """Take what a run takes."""

        def run(self):
            raise EndedByWatchdogError("The watchdog ended it.", remedy="Look.")

    monkeypatch.setattr("station.app.lifecycle.StationRun", EndedRun)

    outcome = run("run")

    assert outcome.code == 3
    assert outcome.err == "error: The watchdog ended it.\nLook.\n"


@pytest.mark.parametrize("factor", ["1e-6", "1e-308", "101"])
def test_a_factor_out_of_range_is_refused_with_the_range(run, started, factor):
    outcome = run(f"run --real-time-factor {factor}")

    assert outcome.code == 1
    assert "0.01 to 100" in outcome.err
    assert started == []


@pytest.mark.usefixtures("started")
def test_the_log_can_be_json(run, monkeypatch):
    forms = []
    monkeypatch.setattr("station.cli.verbs.run.set_up_log", forms.append)

    run("run")
    found = run("run --log-format json")

    assert forms == ["text", "json"]
    assert "warning: something" not in found.err


@pytest.fixture
def runs(monkeypatch):
    """The runs that the verb has begun; none of them serves."""
    begun = []

    def run(self):
        begun.append(self)
        self.tell("ready")
        return FciCounts()

    monkeypatch.setattr(FciRun, "run", run)
    return begun


def test_the_configured_arm_is_served_where_it_is_told(runs, tmp_path, capsys):
    file = tmp_path / "station.yaml"
    file.write_text("robot: {arm_id: left}\n", encoding="utf-8")
    code = main(["fci", str(file), "--host", "127.0.0.9", "--patience", "0.5"])
    assert code == 0
    (run,) = runs
    assert run.config.robot_parameters()["arm_id"] == "left"
    assert (run.settings.host, run.settings.patience) == ("127.0.0.9", 0.5)
    assert capsys.readouterr().out == "ready\n"


@pytest.mark.parametrize(
    ("line", "port"), [("", None), ("--desk", 443), ("--desk 8443", 8443)]
)
def test_desk_is_served_when_told(runs, line, port):
    assert main(["fci", *line.split()]) == 0
    assert runs[0].desk_port == port


@pytest.mark.usefixtures("runs")
def test_json_is_a_line_per_message(capsys):
    assert main(["fci", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"message": "ready"}


def test_directory_is_printed(run, monkeypatch):
    def fetch(tell):
        tell("Fetching.")
        return Path("/data/panda")

    monkeypatch.setattr("station.app.panda_fetch.fetch_panda", fetch)

    outcome = run("fetch-robot")

    assert (outcome.code, outcome.out) == (0, "/data/panda\n")
    assert outcome.err == "Fetching.\n"
    assert json.loads(run("fetch_robot --json").out) == {"directory": "/data/panda"}


def test_it_listens_to_this_machine_alone_and_waits_for_nobody_unless_told():
    options = parse(["fci"])
    assert (options.host, options.patience, options.config) == ("127.0.0.1", 0.0, None)
    options = parse(["fci", "--patience", "0.25"])
    assert options.patience == 0.25


@pytest.mark.parametrize("wrong", ["-1", "10.1", "nan", "soon"])
def test_impossible_patience_is_refused(wrong, capsys):
    with pytest.raises(SystemExit) as end:
        parse(["fci", f"--patience={wrong}"])
    assert end.value.code == 2
    assert "0 to 10" in capsys.readouterr().err


def test_run_takes_a_robot_and_its_base() -> None:
    options = parse([
        "run",
        "--robot",
        "r.urdf",
        "--base",
        "planar",
    ])
    assert (options.robot, options.base) == ("r.urdf", "planar")
    assert options.config is None


def test_doctor_looks_at_a_robot_if_there_is_one() -> None:
    assert parse(["doctor"]).robot is None
    assert parse(["doctor", "r.urdf"]).robot == "r.urdf"
