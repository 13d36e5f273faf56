"""Bodies are parsed strictly."""

import pytest

from tests.api.test_errors import problem_of


@pytest.mark.parametrize(
    "number", ["NaN", "Infinity", "-Infinity", "1e999", "+1", "01"]
)
def test_what_json_does_not_have_is_refused_with_its_place(operator, number):
    answer = operator.put(
        "/api/v1/controllers/spring/command",
        content=f'{{"command": [{number}]}}',
        headers={"Content-Type": "application/json"},
    )

    problem = problem_of(answer, 422, "invalid_request")
    assert "body" in problem["detail"]


def test_text_is_read_as_unicode(operator, station):
    operator.post("/api/v1/stop", json={"reason": "Rauch über dem Roboter 🔥"})

    assert station.loop.stop_latch.reason == "Rauch über dem Roboter 🔥"
