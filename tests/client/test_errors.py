"""What a refusal looks like to a script."""

import pytest

from station.client.errors import ApiError, StationUnreachableError


def test_an_error_reads_as_the_station_worded_it():
    body = (
        b'{"type": "t", "title": "T", "status": 404, "detail": "No controller \'a\'.",'
        b' "code": "c", "remedy": "Load it.", "details": {"known": ["b"]},'
        b' "errors": [{"field": "f", "message": "m"}]}'
    )

    error = ApiError.from_body(404, body)

    assert str(error) == "No controller 'a'. Load it."
    assert (error.status, error.code, error.remedy) == (404, "c", "Load it.")
    assert error.details == {"known": ["b"]}
    assert error.errors[0].field == "f"


@pytest.mark.parametrize("body", [b"", b"<html>Bad Gateway", b"[]", b"{}", b"\xff"])
def test_an_answer_of_something_else_is_quoted(body):
    error = ApiError.from_body(502, body)

    assert error.code == "not_a_station"
    assert error.status == 502
    assert "502" in str(error)


def test_no_answer_is_an_api_error_too():
    error = StationUnreachableError("http://x", TimeoutError())

    assert isinstance(error, ApiError)
    assert error.status == 0
    assert "http://x" in str(error)
    assert "TimeoutError" in str(error)
    assert "station run" in error.remedy
