"""Answer the requests of logged-in sessions, and refuse those of others."""

from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING, Protocol, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from station.client import ApiError
from station.ui.sessions.sessions import Role, Session

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.websockets import WebSocket


class RefusedError(Exception):
    """A refusal of a request of the page.

    Args:
        status: HTTP status.
        code: The reason, for programs.
        detail: The reason, for people.
        remedy: Advice to the user; empty if nothing helps.
    """

    def __init__(self, status: int, code: str, detail: str, remedy: str = "") -> None:
        super().__init__(detail)
        self.status = status
        self.code = code
        self.detail = detail
        self.remedy = remedy

    def answer(self) -> JSONResponse:
        """Return the refusal in the form of the station's refusals."""
        body = {
            "status": self.status,
            "code": self.code,
            "detail": self.detail,
            "remedy": self.remedy,
        }
        return JSONResponse(body, self.status, media_type="application/problem+json")


class Body(BaseModel):
    """The body of a request of the page."""

    model_config = ConfigDict(extra="forbid", strict=True)


_Wanted = TypeVar("_Wanted", bound=Body)


class FindSession(Protocol):
    """Finds the session of a connection."""

    def __call__(self, connection: "Request | WebSocket") -> Session | None:
        """Return the session of a connection, or None."""
        ...


class SessionRoutes:
    """Makes routes that answer logged-in sessions only.

    Args:
        find: Returns the session of a connection.
    """

    def __init__(self, find: FindSession) -> None:
        self.find = find

    def route(
        self,
        method: str,
        path: str,
        answer: "Callable[[Session, Request], Awaitable[Response]]",
        *,
        operators_only: bool = False,
    ) -> Route:
        """Return a route.

        Args:
            method: The HTTP method.
            path: The path.
            answer: Answers a request. Its `RefusedError` and `ApiError` become
                refusals.
            operators_only: Whether viewers are refused.
        """

        async def endpoint(request: "Request") -> Response:
            session = self.find(request)
            try:
                if session is None:
                    raise RefusedError(401, "no_session", "Log in first.")
                if operators_only and session.role is not Role.OPERATOR:
                    raise RefusedError(403, "forbidden", "Viewers only watch.")
                return await answer(session, request)
            except ApiError as error:
                status = error.status or 502
                detail, remedy = error.detail, error.remedy
                return RefusedError(status, error.code, detail, remedy).answer()
            except RefusedError as refusal:
                return refusal.answer()

        return Route(path, endpoint, methods=[method])

    def route_of(
        self,
        method: str,
        path: str,
        kind: type[_Wanted],
        answer: Callable[[Session, _Wanted], Awaitable[Response]],
        *,
        operators_only: bool = False,
    ) -> Route:
        """Return a route whose requests have a body; as `route`.

        Args:
            method: The HTTP method.
            path: The path.
            kind: The model of the body; another body is refused.
            answer: Answers a request with this body.
            operators_only: Whether viewers are refused.
        """

        async def read_and_answer(session: Session, request: "Request") -> Response:
            try:
                wanted = kind.model_validate_json(await request.body())
            except ValidationError as error:
                first = error.errors()[0]
                place = ".".join(map(str, first["loc"])) or "the body"
                detail = f"{place}: {first['msg']}."
                raise RefusedError(422, "invalid_request", detail) from error
            return await answer(session, wanted)

        return self.route(method, path, read_and_answer, operators_only=operators_only)
