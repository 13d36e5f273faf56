"""HEAD, entity tags, and compression: for JSON that comes whole, and nothing else."""

import httpx
import pytest

from station.api.app import create_app
from station.api.auth import Authenticator
from station.api.representation import LARGE
from station.api.server import ApiServer
from tests.api.conftest import OPERATOR
from tests.api.test_who_gets_in import bearer, routes_of
from tests.for_each import for_each
from tests.franka_station import make_franka_station

DOCUMENT = "/api/v1/openapi.json"
SMALL = "/api/v1/stop"
EVENTS = {"Accept": "text/event-stream"}


def test_what_has_not_changed_is_not_sent_again(operator):
    first = operator.get(SMALL)
    tag = first.headers["etag"]
    again = operator.get(SMALL, headers={"If-None-Match": f'"other", {tag}'})

    assert (again.status_code, again.content) == (304, b"")
    assert again.headers["etag"] == tag
    assert "content-length" not in again.headers
    assert operator.get(SMALL, headers={"If-None-Match": "*"}).status_code == 304


def test_what_has_changed_is_sent(operator, station):
    tag = operator.get(SMALL).headers["etag"]
    station.stop("Somebody is in the cell.")
    changed = operator.get(SMALL, headers={"If-None-Match": tag})

    assert changed.status_code == 200
    assert changed.headers["etag"] != tag


@pytest.mark.usefixtures("spring")
def test_the_tag_of_gains_is_their_own(operator):
    path = "/api/v1/controllers/spring/gains"
    answer = operator.get(path)

    assert not answer.headers["etag"].startswith("W/")
    assert answer.json()["etag"] == answer.headers["etag"]
    tag = {"If-None-Match": answer.headers["etag"]}
    assert operator.get(path, headers=tag).status_code == 304


@for_each(
    "path, accepted, coding",
    [
        (DOCUMENT, "gzip", "gzip"),
        (DOCUMENT, "br, gzip;q=0.5", "gzip"),
        (DOCUMENT, "identity", None),
        (DOCUMENT, "gzip;q=0, identity", None),
        (DOCUMENT, "", None),
        (SMALL, "gzip", None),
    ],
)
def test_large_json_is_compressed_for_who_takes_it(operator, path, accepted, coding):
    plain = operator.get(path, headers={"Accept-Encoding": "identity"})
    answer = operator.get(path, headers={"Accept-Encoding": accepted})

    assert answer.headers.get("content-encoding") == coding
    assert answer.json() == plain.json()
    assert answer.headers["etag"] == plain.headers["etag"]
    assert ("vary" in answer.headers) == (len(plain.content) >= LARGE)


def test_documents_may_be_kept_and_answers_about_the_robot_not(operator):
    assert operator.get(DOCUMENT).headers["cache-control"] == "no-cache"
    assert operator.get(SMALL).headers["cache-control"] == "no-store"


def test_every_head_is_that_of_its_get():
    app = create_app(make_franka_station(), Authenticator(OPERATOR))
    paths = [path for method, path in routes_of(app) if method == "GET"]
    different = {"x-request-id", "x-station-clock", "content-length", "etag", "date"}
    with (
        ApiServer(app, port=0) as server,
        httpx.Client(base_url=server.url, trust_env=False) as client,
    ):
        client.headers.update(bearer(OPERATOR))
        for path in paths:
            head = client.head(path)
            with client.stream("GET", path) as get:
                assert head.status_code == get.status_code, path
                for name in head.headers.keys() - different:
                    assert head.headers[name] == get.headers[name], (path, name)
                assert ("content-length" in head.headers) == (
                    "content-length" in get.headers
                ), path
            assert head.content == b""

    assert len(paths) > 50


def test_the_head_of_an_endless_stream_ends(server):
    headers = {**bearer(OPERATOR), **EVENTS}
    answer = httpx.head(
        f"{server.url}/api/v1/events", headers=headers, timeout=5.0, trust_env=False
    )

    assert answer.status_code == 200
    assert answer.headers["content-type"].startswith("text/event-stream")


def test_events_are_not_held_back(server):
    headers = {**bearer(OPERATOR), **EVENTS, "Accept-Encoding": "gzip"}
    with (
        httpx.Client(base_url=server.url, trust_env=False, timeout=5.0) as client,
        client.stream("GET", "/api/v1/events?since=0", headers=headers) as answer,
    ):
        assert "content-encoding" not in answer.headers
        assert next(answer.iter_bytes())
