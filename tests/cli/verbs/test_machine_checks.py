"""The checks say what is there, and what to do when that is not enough."""

import os
import shutil
import socket

import pytest

from station.cli.verbs import doctor as checks
from station.compiled import CompilationStatus


@pytest.mark.parametrize(
    "check", [c for c in checks.CHECKS if c is not checks.check_clock]
)
def test_check_finds_something(check):
    finding = check()

    assert finding.state in {"ok", "warning", "problem"}
    assert finding.finding
    assert (finding.state == "ok") == (finding.advice == "")


def test_clock_is_measured():
    finding = checks.check_clock(cycles=10)

    assert "p99" in finding.finding


def test_an_interpreted_cycle_is_a_warning(monkeypatch):
    status = CompilationStatus("interpreted", "No C compiler was found.")
    monkeypatch.setattr(checks, "present_status", lambda: status)

    found = checks.check_extensions()

    assert (found.state, found.finding) == ("warning", status.text())


@pytest.mark.parametrize(
    "status",
    [
        CompilationStatus("compiled", "It fits."),
        CompilationStatus(
            "interpreted", "STATION_COMPILED=0 asks for it.", is_forced=True
        ),
    ],
)
def test_what_was_asked_for_is_no_warning(monkeypatch, status):
    monkeypatch.setattr(checks, "present_status", lambda: status)

    found = checks.check_extensions()

    assert (found.state, found.finding) == ("ok", status.text())


def test_one_processor_is_a_warning(monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0})

    assert checks.check_processors().state == "warning"


def test_slow_governor_is_a_warning(tmp_path):
    governor = tmp_path / "scaling_governor"
    governor.write_text("powersave\n")

    assert checks.check_governor(governor).state == "warning"
    governor.write_text("performance\n")
    assert checks.check_governor(governor).state == "ok"


def test_refused_realtime_is_a_warning(monkeypatch):
    monkeypatch.setattr(checks, "request_realtime_priority", lambda: "SCHED_OTHER (no)")

    finding = checks.check_scheduler()

    assert (finding.state, finding.finding) == ("warning", "SCHED_OTHER (no)")


def test_missing_package_is_a_problem(monkeypatch):
    monkeypatch.setattr(checks, "_PACKAGES", ("numpy", "no-such-package"))

    finding = checks.check_packages()

    assert finding.state == "problem"
    assert "no-such-package" in finding.finding


def test_missing_browser_is_a_warning(monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda _: None)

    assert checks.check_browser().state == "warning"


def test_taken_port_is_a_warning():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        assert checks.check_port(taken.getsockname()[1]).state == "warning"
