"""Verb `fci check`: pytest is called with the endpoint, and its result is told."""

import json
import subprocess
from pathlib import Path
from types import SimpleNamespace

import pytest

from station.cli import main
from station.cli.parser import parse
from station.cli.verbs import fci_check


@pytest.fixture
def called(monkeypatch):
    """The commands that were run; each writes a report, and none checks anything."""
    commands = []

    def run(command, **_options):
        commands.append(command)
        report = next(one for one in command if one.startswith("--fci-report="))
        Path(report.partition("=")[2]).write_text('{"checks": []}', encoding="utf-8")
        return SimpleNamespace(returncode=len(commands) - 1)

    monkeypatch.setattr(subprocess, "run", run)
    return commands


def test_endpoint_and_version_reach_the_checks(called, tmp_path):
    line = f"fci check arm.local --version 7 --port 4000 --report {tmp_path / 'r.json'}"
    assert main(line.split()) == 0
    (command,) = called
    assert command[command.index("--fci") + 1] == "arm.local"
    assert {"--fci-port=4000", "--fci-version=7"} < set(command)
    assert "--fci-move" not in command
    assert "--no-summary" not in command  # pytest 9.0 then prints no matrix
    assert json.loads((tmp_path / "r.json").read_text()) == {"checks": []}


def test_arm_moves_when_told_and_failed_checks_are_the_exit_code(called, capsys):
    assert main(["fci", "check", "arm", "--move"]) == 0
    assert main(["fci", "check", "arm", "--json"]) == 1
    assert ["--fci-move" in command for command in called] == [True, False]
    assert json.loads(capsys.readouterr().out) == {"checks": []}


def test_help_warns_of_the_motions(capsys):
    with pytest.raises(SystemExit):
        parse(["fci", "--help"])
    told = " ".join(capsys.readouterr().out.split())
    assert "THE ARM MOVES AND IS STOPPED BY ERRORS ON PURPOSE" in told


def test_address_and_pytest_are_needed(monkeypatch, capsys):
    assert main(["fci", "check"]) == 2
    assert "needs the address of an arm" in capsys.readouterr().err
    monkeypatch.setattr(fci_check, "find_spec", lambda _name: None)
    assert main(["fci", "check", "arm"]) == 2
    assert "pip install pytest" in capsys.readouterr().err


def test_nobody_at_the_address_is_told_in_libfrankas_words(capfd):
    assert main(["fci", "check", "127.0.0.1", "--port", "1"]) == 1
    assert "Connection to FCI refused at 127.0.0.1:1" in capfd.readouterr().err


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("--move", "--move belongs to `station fci check ADDRESS`"),
        ("station.yaml 127.0.0.1", "ADDRESS belongs to `station fci check ADDRESS`"),
        ("--port 2000", "`station fci` has no --port"),
        ("check arm --patience 2", "--patience belongs to `station fci`"),
        ("check arm --desk", "`station fci check ADDRESS` has no --desk"),
        ("check arm --report /nowhere/at/all.json", "has no folder"),
    ],
)
def test_option_that_would_mean_nothing_is_refused(line, told, called, capsys):
    assert main(["fci", *line.split()]) == 2
    assert told in capsys.readouterr().err
    assert not called


@pytest.mark.parametrize("option", ["--port 65536", "--port -1", "--desk x"])
def test_impossible_port_is_refused(option, capsys):
    with pytest.raises(SystemExit):
        parse(["fci", "check", "arm", *option.split()])
    assert "0 to 65535" in capsys.readouterr().err
