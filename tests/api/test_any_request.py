"""Whatever is sent to a route, its answer is one that the OpenAPI document promises.

Requests are made up from the document itself, sound ones and broken ones.
"""

from datetime import timedelta

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
from tests.api.conftest import OPERATOR, URL, VIEWER, AppTransport
from tests.franka_station import make_franka_station

AUTHORIZED = {"Authorization": f"Bearer {OPERATOR}"}
HOST = {"Host": "127.0.0.1:8000"}
PROMISED = [
    status_code_conformance,
    content_type_conformance,
    response_schema_conformance,
]
STOP = "POST /api/v1/stop"
"""It stops whatever it is told."""

APP = create_app(make_franka_station(), Authenticator(OPERATOR, VIEWER))
OPERATIONS = {
    operation.label: operation
    for operation in (
        found.ok()
        for found in schemathesis.openapi.from_asgi(
            "/api/v1/openapi.json", APP, headers=HOST
        ).get_all_operations()
    )
    if "/streams/" not in operation.label
}


@pytest.mark.parametrize("name", OPERATIONS)
def test_every_answer_is_a_promised_one(name):
    checks = PROMISED if name == STOP else [*PROMISED, negative_data_rejection]

    @settings(
        max_examples=20,
        derandomize=True,
        database=None,
        deadline=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(case=OPERATIONS[name].as_strategy())
    def send(case):
        request = case.as_transport_kwargs(base_url=URL)
        request["content"] = request.pop("data", None)
        request.pop("cookies", None)
        answer = client.request(**request)
        answer.elapsed = timedelta()
        case.validate_response(answer, checks=checks)

    with httpx.Client(transport=AppTransport(APP), headers=AUTHORIZED) as client:
        send()
