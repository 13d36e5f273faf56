"""Probes for supervisors."""

import pytest

from station.client import ApiError
from tests.api.test_errors import problem_of


def test_health_needs_no_token(http, station):
    answer = http.get("/api/v1/health")

    assert answer.json() == {"status": "ok", "boot_id": station.boot_id}


def test_a_dead_loop_is_not_healthy_and_says_why(http, station, monkeypatch):
    monkeypatch.setattr(station, "dead", lambda: "The control loop died: no cable")

    problem = problem_of(http.get("/api/v1/health"), 503, "loop_died")

    assert "no cable" in problem["detail"]


def test_not_ready_says_why_and_needs_no_token(http):
    problem = problem_of(http.get("/api/v1/ready"), 503, "not_ready")

    assert "not running" in problem["detail"]


def test_ready_while_the_loop_runs(client, station, monkeypatch):
    monkeypatch.setattr(station, "ready", lambda: None)
    assert client.ready().ready is True

    monkeypatch.setattr(station, "ready", lambda: "The loop hangs.")
    with pytest.raises(ApiError, match="The loop hangs"):
        client.ready()
