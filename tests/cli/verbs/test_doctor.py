"""Verb `doctor`."""

import json

import pytest

from station.cli.verbs.doctor import Finding


@pytest.fixture
def findings(monkeypatch):
    """Return a function that sets what the checks find."""

    def set_findings(*found):
        checks = [lambda finding=finding: finding for finding in found]
        monkeypatch.setattr("station.cli.verbs.doctor.CHECKS", checks)

    return set_findings


def test_advice_is_given(run, findings):
    findings(Finding("clock", "warning", "late", "Hurry."), Finding("x", "ok", "y"))

    outcome = run("doctor")

    assert outcome.code == 0
    assert "clock: Hurry." in outcome.out.splitlines()


def test_problem_is_1(run, findings):
    findings(Finding("packages", "problem", "missing", "Install."))

    assert run("doctor").code == 1


def test_findings_can_be_json(run, findings):
    findings(Finding("x", "ok", "y"))

    assert json.loads(run("doctor --json").out) == [
        {"check": "x", "state": "ok", "finding": "y", "advice": ""}
    ]
