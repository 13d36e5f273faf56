"""Whatever is sent to a route, its answer is one that the OpenAPI document promises.

Requests are made up from the document itself, sound ones and broken ones.
"""

import os
from datetime import timedelta
from functools import cache

import httpx
import pytest
import schemathesis
from hypothesis import HealthCheck, Phase, given, settings
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    negative_data_rejection,
    response_schema_conformance,
    status_code_conformance,
)

from station.api.app import create_app
from station.api.auth import Authenticator
from station.core.control.switching import SwitchRequest
from tests.api.conftest import OPERATOR, URL, VIEWER, AppTransport
from tests.for_each import for_each
from tests.franka_station import make_franka_station

pytestmark = pytest.mark.slow

PROMISED = [
    status_code_conformance,
    content_type_conformance,
    response_schema_conformance,
]
STOP = "POST /api/v1/stop"
"""It stops whatever it is told."""

EXAMPLES = int(os.environ.get("MADE_UP_REQUESTS", "2"))
"""Requests of each operation."""

KNOWN = {"name": "arm", "arm_id": "panda"}


def make_app():
    """Return the app over an arm whose controller `arm` runs."""
    station = make_franka_station()
    station.switch_controllers(SwitchRequest(["arm"]))
    return create_app(station, Authenticator(OPERATOR, VIEWER))


@cache
def read_app():
    """Return an app for requests that change nothing."""
    return make_app()


@cache
def operations():
    """Return what can be asked of the app, by method and path."""
    with httpx.Client(transport=AppTransport(read_app())) as client:
        answer = client.get(f"{URL}/api/v1/openapi.json")
    document = schemathesis.openapi.from_dict(answer.json())
    found = (one.ok() for one in document.get_all_operations())
    return {one.label: one for one in found if "/streams/" not in one.label}


def send_made_up_requests(name, known, checks):
    """Send requests of operation `name` with `known` path parameters."""

    @settings(
        max_examples=EXAMPLES,
        derandomize=True,
        database=None,
        deadline=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(case=operations()[name].as_strategy())
    def send(case):
        for parameter in case.path_parameters.keys() & known.keys():
            case.path_parameters[parameter] = known[parameter]
        request = case.as_transport_kwargs(base_url=URL)
        request["content"] = request.pop("data", None)
        request.pop("cookies", None)
        request["headers"]["Authorization"] = f"Bearer {OPERATOR}"
        answer = client.request(**request)
        answer.elapsed = timedelta()
        case.validate_response(answer, checks=checks)

    app = read_app() if name.startswith("GET ") else make_app()
    with httpx.Client(transport=AppTransport(app)) as client:
        send()


@for_each("name", lambda: sorted(operations().keys() - {STOP}))
def test_every_operation_refuses_malformed_requests(name):
    send_made_up_requests(name, {}, [*PROMISED, negative_data_rejection])


def operations_of_known_things():
    """Return what asks for a thing that can exist; the rest is asked the same above."""
    asked = (label for label in operations() if any(f"{{{k}}}" in label for k in KNOWN))
    return sorted({*asked, STOP})


@for_each("name", operations_of_known_things)
def test_every_answer_about_existing_things_is_documented(name):
    send_made_up_requests(name, KNOWN, PROMISED)
