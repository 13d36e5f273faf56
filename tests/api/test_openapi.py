"""The OpenAPI document."""

import json
import re
import threading
from importlib import import_module
from pkgutil import iter_modules

from jsonschema import Draft202012Validator

from station import wire
from tests.api.openapi_document import document, operations
from tests.for_each import for_each

DOCUMENT = document()
SCHEMAS = DOCUMENT["components"]["schemas"]
OPERATIONS = [
    (f"{method} {path}", operation)
    for (method, path), operation in operations().items()
]


def test_document_is_openapi_3_1_and_all_its_references_exist():
    assert DOCUMENT["openapi"].startswith("3.1")
    schemas = DOCUMENT["components"]["schemas"]
    parts = json.dumps(DOCUMENT).split('"#/components/schemas/')[1:]
    assert parts
    assert {part.partition('"')[0] for part in parts} <= set(schemas)


@for_each("name, operation", OPERATIONS, ids=lambda case: case[0])
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


def test_every_property_is_described():
    missing = [
        f"{name}.{key}"
        for name, schema in SCHEMAS.items()
        for key, found in schema.get("properties", {}).items()
        if not found.get("description", "").strip()
    ]

    assert missing == [], "describe these in the docstrings of the wire models"


def test_every_quantity_says_its_unit():
    quantities = re.compile(
        r"torque|stiffness|velocit|acceleration|position|mass|inertia|force|time$|period"
        r"|duration|width|speed|lateness|timeout",
        re.IGNORECASE,
    )
    unit = re.compile(r"\[[^\]]+\]|unit|ISO 8601|null|`|0 to 1")
    found = [
        f"{name}.{key}: {schema['properties'][key]['description']}"
        for name, schema in SCHEMAS.items()
        for key in schema.get("properties", {})
        if quantities.search(key) and is_number(schema["properties"][key])
        if not unit.search(schema["properties"][key]["description"])
    ]

    assert found == []


def is_number(schema):
    """Return whether a property is a number, or numbers in a list."""
    kinds = json.dumps(schema)
    return '"number"' in kinds


def test_every_parameter_is_described():
    missing = [
        f"{name}: {parameter['name']}"
        for name, operation in OPERATIONS
        for parameter in operation.get("parameters", [])
        if not (parameter.get("description") and has_example(parameter))
    ]

    assert missing == []


def has_example(parameter):
    return "example" in parameter or "examples" in parameter["schema"]


def test_every_body_has_an_example_that_its_model_accepts():
    for name, operation in OPERATIONS:
        body = operation.get("requestBody")
        # A file has no model.
        if body is None or "application/json" not in body["content"]:
            continue
        schema = body["content"]["application/json"]["schema"]
        models = re.findall(r"#/components/schemas/(\w+)", json.dumps(schema))
        found = SCHEMAS[models[0]] if models else schema
        assert found.get("examples"), name
        for example in found["examples"]:
            if models:
                wire_model(models[0]).model_validate(example)


def wire_model(name):
    """Return a wire model, in whatever module of the wire it is."""
    modules = [
        import_module(f"station.wire.{m.name}") for m in iter_modules(wire.__path__)
    ]
    return next(getattr(m, name) for m in modules if hasattr(m, name))


def test_operations_have_short_names_of_their_own():
    names = [operation["operationId"] for _, operation in OPERATIONS]

    assert len(set(names)) == len(names)
    assert all(re.fullmatch(r"[a-z][a-z_]{2,40}", name) for name in names)


def test_tags_are_described():
    described = {tag["name"]: tag["description"] for tag in DOCUMENT["tags"]}

    assert {tag for _, one in OPERATIONS for tag in one["tags"]} == set(described)
    assert all(described.values())


def test_headers_of_answers_are_declared(operator, client):
    client.load_controller("spring", "test/Spring", {"joint": "j"})
    responses = dict(OPERATIONS)["GET /api/v1/controllers/{name}/gains"]["responses"]

    answer = operator.get("/api/v1/controllers/spring/gains")
    assert set(responses["200"]["headers"]) == {"X-Request-ID", "ETag"}
    assert all(name in answer.headers for name in responses["200"]["headers"])
    del operator.headers["Authorization"]
    refused = operator.get("/api/v1/controllers/spring/gains")
    assert all(name in refused.headers for name in responses["401"]["headers"])


def test_the_document_needs_no_token(http):
    assert http.get("/api/v1/openapi.json").json()["info"] == DOCUMENT["info"]


def parts_of(node, path=""):
    """Return every object of the document, with its place."""
    if isinstance(node, dict):
        yield path, node
    pairs = node.items() if isinstance(node, dict) else enumerate(node)
    for key, value in pairs if isinstance(node, (dict, list)) else ():
        if isinstance(value, (dict, list)):
            yield from parts_of(value, f"{path}/{key}")


def examples():
    """Return place, schema and value of every example and default."""
    for path, part in parts_of(DOCUMENT):
        if path.endswith("/properties"):
            continue
        if isinstance(part.get("schema"), dict) and "example" in part:
            yield path, part["schema"], part["example"]
        if part.keys() & {"type", "$ref", "anyOf", "oneOf"}:
            for value in part.get("examples", ()):
                yield path, part, value
            if "default" in part:
                yield path, part, part["default"]


def test_every_example_fits_its_schema():
    found = list(examples())
    wrong = []
    for path, schema, value in found:
        whole = {**schema, "components": DOCUMENT["components"]}
        errors = Draft202012Validator(whole).iter_errors(value)
        wrong += [f"{path}: {error.message}" for error in errors]

    assert wrong == []
    assert len(found) > 200


def test_members_of_a_union_are_told_apart_by_a_tag_they_must_have():
    unions = [part for _, part in parts_of(DOCUMENT) if "oneOf" in part]

    assert unions
    for union in unions:
        tag = union["discriminator"]["propertyName"]
        for reference in union["discriminator"]["mapping"].values():
            assert tag in SCHEMAS[reference.rpartition("/")[2]]["required"]


def test_the_document_says_where_the_server_is_and_what_needs_a_token():
    without = {name for name, operation in OPERATIONS if operation["security"] == []}

    assert DOCUMENT["servers"]
    assert without == {
        "GET /api/v1/health",
        "GET /api/v1/ready",
        "POST /api/v1/login",
        "POST /api/v1/logout",
    }


def test_the_document_is_made_beside_the_event_loop(http, app, monkeypatch):
    threads = []
    monkeypatch.setattr(app, "openapi", lambda: threads.append(threading.get_ident()))
    http.get("/api/v1/openapi.json")
    http.get("/api/v1/openapi.json")

    assert len(threads) == 1
    assert threads[0] != threading.get_ident()
