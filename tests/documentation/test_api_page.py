"""docs/api.md tells the whole API: routes, access, statuses, topics, close codes."""

import re

from station.api.routes.routing import MEANINGS
from station.api.streams import broadcaster
from station.api.streams.topics import (
    ControllerStateTopic,
    CycleTopic,
    RobotStateTopic,
    Topic,
)
from station.wire import protocol
from station.wire.protocol import PREFIX
from tests.api.openapi_document import operations
from tests.documentation.shell_examples import (
    EVERY_ROUTE,
    ROOT,
    commands,
    curl_request,
)
from tests.for_each import for_each

PAGE = ROOT / "docs" / "api.md"
OPEN = {"/health", "/ready", "/login", "/logout"}
FOR_VIEWERS = {"/stop", "/stream-tickets"}
OPERATIONS = [(method, path.removeprefix(PREFIX)) for method, path in operations()]


def rows(header: str) -> list[list[str]]:
    """Return the cells of the table whose first header cell is `header`."""
    _, _, table = PAGE.read_text().partition(f"| {header} |")
    lines = table.partition("\n\n")[0].splitlines()[2:]
    return [[cell.strip(" `") for cell in line.strip("|").split("|")] for line in lines]


def test_every_route_is_below_one_that_the_page_names():
    named = set(re.findall(r"/[\w-]+", str([row[1] for row in rows("Subject")])))

    assert named == {f"/{route.split('/')[1]}" for _, route in OPERATIONS}


@for_each("method, route", OPERATIONS)
def test_access_is_what_the_page_says(http, method, route):
    """The page has a rule, and names the exceptions."""
    url = PREFIX + re.sub(r"\{\w+\}", "x", route)

    anonymous = http.request(method, url)
    viewer = http.request(method, url, headers={"Authorization": "Bearer viewer-token"})

    assert (anonymous.status_code == 401) == (route not in OPEN)
    for_operators = method != "GET" and route not in OPEN | FOR_VIEWERS
    for_operators |= route == "/tokens"
    assert (viewer.status_code == 403) == for_operators


def test_every_route_has_an_example_with_curl():
    tried = []
    for command in commands(EVERY_ROUTE, {"API": ""}):
        request = curl_request(command.words)
        tried.append((request.method, request.url.partition("?")[0]))

    for method, route in OPERATIONS:
        pattern = re.compile(re.sub(r"\{\w+\}", "[^/]+", route))
        assert any(m == method and pattern.fullmatch(u) for m, u in tried), route


def test_statuses_to_know_are_those_of_the_api():
    listed = {int(status) for status, _ in rows("Status")}

    assert listed
    assert listed <= set(MEANINGS)


def test_close_codes_are_those_of_the_streams():
    known = {v for n, v in vars(protocol).items() if n.startswith("CLOSE_")}
    known.add(broadcaster.CLOSE_INTERNAL_ERROR)

    assert {int(code) for code, _ in rows("Close code")} == known


def test_topics_have_the_rate_of_the_page():
    kinds = [kind for base in (Topic, CycleTopic) for kind in base.__subclasses__()]
    reports = [kind for base in kinds for kind in base.__subclasses__()]
    families = {
        ControllerStateTopic: "controller_state/{name}",
        RobotStateTopic: "robot_state/{arm_id}",
    }
    topics = {
        getattr(kind, "name", families.get(kind)): kind
        for kind in {*kinds, *reports}
        if not kind.__abstractmethods__
    }

    for name, rate in rows("Topic"):
        assert float(rate) == topics[name].default_rate
    assert {row[0] for row in rows("Topic")} == set(topics)
