"""Every request has a name, in its answer and in the log."""

import asyncio
import logging

import httpx
import pytest
from starlette.applications import Starlette
from starlette.responses import PlainTextResponse
from starlette.routing import Route

from station.web.request_id import RequestId, RequestIdFilter, present_request_id
from tests.api.conftest import URL, AppTransport


def name(_):
    return PlainTextResponse(str(present_request_id()))


@pytest.fixture
def client():
    app = Starlette(routes=[Route("/name", name, methods=["GET", "POST"])])
    with httpx.Client(transport=AppTransport(RequestId(app)), base_url=URL) as client:
        yield client


@pytest.mark.parametrize("given", ["abc-1", "A.b_c:d", "x" * 64])
def test_a_clients_name_is_kept(client, given):
    answer = client.get("/name", headers={"X-Request-ID": given})

    assert answer.headers["X-Request-ID"] == answer.text == given


@pytest.mark.parametrize("given", [None, "", "a b", "x" * 65, 'a"}\t{"', "é"])
def test_any_other_name_is_replaced(client, given):
    headers = {} if given is None else {"X-Request-ID": given.encode("latin-1")}
    answers = [client.get("/name", headers=headers) for _ in range(2)]

    names = [answer.headers["X-Request-ID"] for answer in answers]
    assert names == [answer.text for answer in answers]
    assert len({*names, given}) == 3
    assert all(len(each) == 32 for each in names)


def test_outside_of_a_request_there_is_no_name(client):
    client.get("/name")

    assert present_request_id() is None


def test_changes_and_refusals_are_logged_under_their_name(client, caplog):
    caplog.set_level(logging.INFO, "station.web.request_id")
    caplog.handler.addFilter(RequestIdFilter())
    headers = {"X-Request-ID": "me"}

    client.get("/name", headers=headers)
    client.post("/name", headers=headers)
    client.get("/nothing", headers=headers)

    lines = [record.getMessage().partition(" in ")[0] for record in caplog.records]
    assert lines == ["POST /name: 200", "GET /nothing: 404"]
    assert {record.request_id for record in caplog.records} == {"me"}


def test_other_messages_of_the_server_pass_untouched():
    seen = []

    async def app(*message):
        seen.append(message)

    asyncio.run(RequestId(app)({"type": "lifespan"}, None, None))
    assert seen == [({"type": "lifespan"}, None, None)]
