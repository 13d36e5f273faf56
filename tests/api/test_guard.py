"""What is refused before it is read."""

import pytest

from station.wire.protocol import MAX_BODY_BYTES
from tests.api.test_errors import problem_of

JSON = {"Content-Type": "application/json"}


@pytest.mark.parametrize("method", ["GET", "POST"])
def test_a_name_that_dns_could_point_here_is_refused(operator, method):
    answer = operator.request(method, "/api/v1/stop", headers={"Host": "evil.example"})

    problem_of(answer, 403, "host_not_allowed")


def test_probes_answer_under_any_name(http):
    answer = http.get("/api/v1/health", headers={"Host": "evil.example"})

    assert answer.status_code == 200


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1"])
def test_a_page_elsewhere_cannot_change_anything(operator, station, origin):
    answer = operator.post("/api/v1/stop", headers={"Origin": origin})

    problem_of(answer, 403, "origin_not_allowed")
    assert station.epoch == 1


def test_the_stations_own_page_can(operator):
    answer = operator.post("/api/v1/stop", headers={"Origin": "http://127.0.0.1:8000"})

    assert answer.status_code == 200


def test_a_large_body_is_refused_by_its_announced_length(operator):
    body = b'{"reason": "' + b"x" * MAX_BODY_BYTES + b'"}'

    answer = operator.post("/api/v1/stop", content=body, headers=JSON)

    problem_of(answer, 413, "body_too_large")


def test_answers_forbid_caching_sniffing_and_framing(operator):
    headers = operator.get("/api/v1/stop").headers

    assert headers["cache-control"] == "no-store"
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["x-frame-options"] == "DENY"
