"""Routes that read their JSON fast: parsing holds the interpreter and so the loop."""

from collections.abc import Callable, Coroutine
from typing import Any

import orjson
from fastapi import Request, Response
from fastapi.routing import APIRoute
from typing_extensions import override

from station.api.errors import ProblemError


class JsonRequest(Request):
    """A request whose body is parsed strictly (NaN is no JSON) and fast."""

    @override
    async def json(self) -> Any:
        """Return the parsed body.

        Raises:
            json.JSONDecodeError: It is no JSON.
        """
        return orjson.loads(await self.body())


class JsonRoute(APIRoute):
    """A route that gets `JsonRequest`s, and refuses bodies that are not JSON."""

    @override
    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        handle = super().get_route_handler()

        async def handle_json(request: Request) -> Response:
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


def _is_json(request: Request) -> bool:
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    return kind == "application/json" or (
        kind.startswith("application/") and kind.endswith("+json")
    )
