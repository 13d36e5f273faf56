"""Routes that parse JSON fast, because parsing delays the control loop."""

import json
from collections import Counter
from collections.abc import Callable, Coroutine
from typing import Any, get_args, get_origin

import orjson
from fastapi import Request, Response
from fastapi.dependencies.models import Dependant
from fastapi.routing import APIRoute
from starlette.types import Message
from typing_extensions import override

from station.api.agents import ASKED
from station.api.dependencies import access, with_leave
from station.api.errors import ProblemError
from station.api.services import services_of

MOST_VALUES = 20_000
"""Most values in one body: members, items, objects and lists. A trajectory with 10,000
numbers, seven per point, has 16,000 values. Each value costs up to 0.3 us in which no
other request is served, not even a stop; the whole body takes 10 ms at most."""
MOST_MEMBERS = 1000
"""Most members of one object: refusing an unknown member costs 4 us, more than any
other check."""
MOST_LEVELS = 200
"""Most levels of nested objects and lists, because Python's parser needs a call for
each level."""


SLASH = "%2F"
"""A slash inside of a name, in the path of a request."""


class DoubleNameError(ValueError):
    """An object has the same key twice, so that one of the values would not count."""


class JsonRequest(Request):
    """A request whose body is parsed fast, and strictly: JSON has no NaN."""

    @override
    async def json(self) -> Any:
        """Return the parsed body.

        Raises:
            json.JSONDecodeError: The body is not JSON.
            ProblemError: The body has too many values, or an object has the same key
                twice.
        """
        text = await self.body()
        body = orjson.loads(text)
        members = _check_values(body)
        # orjson keeps the last member of a name, and does not report two of the same
        # name. Python's parser does, but takes ten times longer, so it reads only
        # bodies with more colons than members. Texts with colons are among these.
        if text.count(b":") > members:
            try:
                check_names(text)
            except DoubleNameError as error:
                raise ProblemError(
                    422,
                    "invalid_request",
                    f"The body {error}.",
                    "Give each key once. Nothing changed.",
                ) from error
        return body


class QueryRoute(APIRoute):
    """A route that refuses unknown or repeated parameters; reads slashes in names."""

    @override
    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        handle = _with_names(super().get_route_handler())
        takes_several = _query_of(self.dependant)
        known = frozenset(takes_several)
        # A misspelt parameter must not be ignored, e.g. a certificate or a filter.
        if not _depends_on_access(self.dependant):
            return handle
        if not known and self.methods == {"GET"}:
            return handle

        async def handle_query(request: Request) -> Response:
            unknown = request.query_params.keys() - known
            given = Counter(name for name, _ in request.query_params.multi_items())
            # Of two values the last one would count, e.g. of two certificates.
            twice = [n for n, often in given.items() if often > 1 and n in known]
            repeated = [name for name in twice if not takes_several[name]]
            authenticator = services_of(request).authenticator
            # Only an authenticated caller learns the names of the parameters.
            if unknown and authenticator.access_of_headers(request.headers):
                raise _unknown_query(sorted(unknown), known)
            if repeated and authenticator.access_of_headers(request.headers):
                raise ProblemError(
                    422,
                    "invalid_request",
                    f"The query has the parameter '{repeated[0]}' "
                    f"{given[repeated[0]]} times; it has one value.",
                    "Give it once. Nothing changed.",
                )
            return await handle(request)

        return handle_query


class JsonRoute(QueryRoute):
    """A route that gets `JsonRequest`s, and refuses bodies that are not JSON.

    The framework reads a body before it checks the token. This route does not read the
    body of a request without a valid token, which would cost the station time.
    """

    def __init__(self, path: str, endpoint: Callable[..., Any], **options: Any) -> None:  # noqa: ANN401 - those of the framework
        if endpoint.__name__ in ASKED:
            endpoint = with_leave(endpoint)
        super().__init__(path, endpoint, **options)

    @override
    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        handle = super().get_route_handler()
        needs_access = _depends_on_access(self.dependant)

        async def handle_json(request: Request) -> Response:
            authenticator = services_of(request).authenticator
            if needs_access and not authenticator.access_of_headers(request.headers):
                return await handle(JsonRequest(request.scope, _no_body))
            asked = JsonRequest(request.scope, request.receive)
            if not _is_json(asked) and await asked.body():
                raise ProblemError(
                    415,
                    "unsupported_media_type",
                    f"The body is {asked.headers.get('content-type', 'of no type')}; "
                    "only JSON is read here.",
                    "Send the header 'Content-Type: application/json' (curl has --json "
                    "DATA for it). Nothing changed.",
                )
            return await handle(asked)

        return handle_json


def _with_names(
    handle: Callable[[Request], Coroutine[Any, Any, Response]],
) -> Callable[[Request], Coroutine[Any, Any, Response]]:
    """Return a handler that reads the names in the path with their slashes."""

    async def handle_names(request: Request) -> Response:
        names: dict[str, Any] = request.scope["path_params"]
        for key, name in names.items():
            names[key] = name.replace(SLASH, "/")
        return await handle(request)

    return handle_names


def _check_values(body: object) -> int:
    values, members, levels, level = 0, 0, 0, [body]
    while level:
        levels += 1
        if levels > MOST_LEVELS:
            raise _too_many(f"more than {MOST_LEVELS} levels", MOST_LEVELS)
        inner: list[object] = []
        for value in level:
            if isinstance(value, dict):
                if len(value) > MOST_MEMBERS:
                    raise _too_many(f"an object of {len(value)} members", MOST_MEMBERS)
                members += len(value)
                inner.extend(value.values())
            elif isinstance(value, list):
                inner.extend(value)
        values += len(inner)
        if values > MOST_VALUES:
            raise _too_many(f"more than {MOST_VALUES} values", MOST_VALUES)
        level = inner
    return members  # of all objects


def check_names(text: bytes | str) -> Any:  # noqa: ANN401 - any JSON
    """Return JSON, unless it has the same key twice in one object.

    Raises:
        DoubleNameError: An object has a key twice.
        ValueError: The text is no JSON.
    """
    return json.loads(text, object_pairs_hook=_check_pairs)


def _check_pairs(pairs: list[tuple[str, object]]) -> dict[str, object]:
    names: dict[str, object] = {}
    for name, value in pairs:
        if name in names:
            raise DoubleNameError(f"has the key '{name:.80}' twice in one object")
        names[name] = value
    return names


def _too_many(found: str, most: int) -> ProblemError:
    return ProblemError(
        413,
        "body_too_large",
        f"The body has {found}; {most} are allowed.",
        "Send it in several requests. Nothing changed.",
    )


def _depends_on_access(dependant: Dependant) -> bool:
    return any(
        one.call is access or _depends_on_access(one) for one in dependant.dependencies
    )


def _query_of(dependant: Dependant) -> dict[str, bool]:
    """Return for each query parameter of a route whether it takes several values."""
    found = {
        field.alias: _is_list(field.field_info.annotation)
        for field in dependant.query_params
    }
    for one in dependant.dependencies:
        found |= _query_of(one)
    return found


def _is_list(kind: object) -> bool:
    return get_origin(kind) is list or any(map(_is_list, get_args(kind)))


def _unknown_query(unknown: list[str], known: frozenset[str]) -> ProblemError:
    return ProblemError(
        422,
        "invalid_request",
        f"The query has the unknown parameter '{unknown[0]:.40}'; allowed are "
        f"{', '.join(sorted(known)) or 'none'}.",
        "Correct the address; /docs has the parameters. Nothing changed.",
    )


async def _no_body() -> Message:
    return {"type": "http.request", "body": b"", "more_body": False}


def _is_json(request: Request) -> bool:
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    return kind == "application/json" or (
        kind.startswith("application/") and kind.endswith("+json")
    )
