"""The stream routes over plain HTTP; over WebSockets see the broadcaster's tests."""

from tests.api.test_errors import problem_of


def test_plain_http_request_of_a_stream_is_asked_to_upgrade(operator):
    answer = operator.get("/api/v1/streams/controller_state/arm")

    problem = problem_of(answer, 426, "websocket_needed")
    assert answer.headers["upgrade"] == "websocket"
    assert "controller_state/arm" in problem["detail"]
