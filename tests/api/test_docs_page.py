"""The documentation works without the internet."""

import re

import pytest

from tests.api.test_errors import problem_of


def test_the_page_asks_nobody_else_for_anything(http):
    answer = http.get("/docs")

    assert answer.status_code == 200
    references = re.findall(r'(?:src|href)="([^"]+)"', answer.text)
    assert [r for r in references if r.startswith("docs/")] == references[1:]
    assert "default-src 'self'" in answer.headers["content-security-policy"]
    assert "<script>" not in answer.text


@pytest.mark.parametrize(
    ("name", "media_type", "sign"),
    [
        ("swagger-ui-bundle.js", "text/javascript", "SwaggerUIBundle"),
        ("swagger-ui.css", "text/css", ".swagger-ui"),
        ("start.js", "text/javascript", "api/v1/openapi.json"),
    ],
)
def test_its_files_are_here(http, name, media_type, sign):
    answer = http.get(f"/docs/{name}")

    assert answer.headers["content-type"].startswith(media_type)
    assert sign in answer.text


@pytest.mark.parametrize("name", ["redoc.standalone.js", "..%2F__init__.py", "x"])
def test_no_other_file_is(http, name):
    problem_of(http.get(f"/docs/{name}"), 404, "route_not_found")


def test_cdn_pages_are_gone(http):
    problem_of(http.get("/redoc"), 404, "route_not_found")
