"""The OpenAPI document."""

import json

import pytest

from station.api.app import create_app
from station.api.auth import Authenticator
from tests.api.spring import make_station

DOCUMENT = create_app(make_station(), Authenticator()).openapi()
OPERATIONS = [
    (f"{method.upper()} {path}", operation)
    for path, methods in DOCUMENT["paths"].items()
    for method, operation in methods.items()
]


def test_document_is_openapi_3_1_and_all_its_references_exist():
    assert DOCUMENT["openapi"].startswith("3.1")
    schemas = DOCUMENT["components"]["schemas"]
    parts = json.dumps(DOCUMENT).split('"#/components/schemas/')[1:]
    assert parts
    assert {part.partition('"')[0] for part in parts} <= set(schemas)


@pytest.mark.parametrize(("name", "operation"), OPERATIONS)
def test_every_operation_documents_its_purpose_and_its_errors(name, operation):
    assert operation["tags"]
    assert operation["description"]
    assert "Raises" not in operation["description"]
    failures = {s: r for s, r in operation["responses"].items() if s[0] in "45"}
    for status, response in failures.items():
        assert response["description"], f"{name} {status}"
        assert response["content"] == {
            "application/problem+json": {
                "schema": {"$ref": "#/components/schemas/Problem"}
            }
        }


@pytest.mark.parametrize("name", ["LoadRequest", "SwitchRequest", "CommandRequest"])
def test_requests_have_examples(name):
    assert DOCUMENT["components"]["schemas"][name]["examples"]


def test_the_document_needs_no_token(http):
    assert http.get("/api/v1/openapi.json").json()["info"] == DOCUMENT["info"]
