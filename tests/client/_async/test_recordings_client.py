"""The asyncio client of recordings: what it asks, and what becomes of the answer."""

import asyncio

import httpx
import pytest

from station.client._async.connection import AsyncConnection
from station.client._async.recordings_client import kept_by_station
from station.client.errors import ApiError


def _recordings(answer):
    transport = httpx.MockTransport(answer)
    return kept_by_station(AsyncConnection("http://station", "t", 1.0, transport))[1]


def test_a_file_is_written_as_it_comes(tmp_path):
    def answer(request):
        assert request.url.path == "/api/v1/recordings/a/file"
        return httpx.Response(200, content=b"bytes")

    path = asyncio.run(_recordings(answer).download("a", tmp_path / "x"))

    assert path.read_bytes() == b"bytes"


def test_a_refusal_makes_no_file(tmp_path):
    recordings = _recordings(lambda _: httpx.Response(404, content=b"{}"))

    with pytest.raises(ApiError):
        asyncio.run(recordings.download("a", tmp_path / "x"))
    assert not (tmp_path / "x").exists()
