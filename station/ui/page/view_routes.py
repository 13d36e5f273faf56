"""Requests of the page about its own 3D view. None of them reaches the station.

`POST /ui/ghost` shows a second, translucent robot in the browsers of the session that
asks, e.g. a recorded or a planned pose; `DELETE /ui/ghost` hides it. A ghost is a
picture: no controller is told of it, so a viewer may show one, too. `PUT /ui/layers`
chooses what is laid over the robots, and `POST /ui/camera` from where they are seen.
`POST /ui/opened` says how much of the view a page hides that has just opened.
`PUT /ui/scheme` says whether the page is dark, so that its 3D view is, too.
A page in which links can be pulled says with `POST /ui/alive` that it lives.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from station.ui.page.control_routes import refused
from station.ui.scene.camera import PRESETS
from station.ui.scene.scene_views import LAYERS, PUSH, Ghost, SceneViews

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.routing import BaseRoute

    from station.ui.page.workspace_routes import FindSession
    from station.ui.sessions.sessions import Session

_MOST_JOINTS = 128
_Finite = Annotated[float, Field(allow_inf_nan=False)]


class _Body(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)


class GhostRequest(_Body):
    """A pose to show.

    Attributes:
        positions: Joint positions by name [rad] or [m]; joints that are not named stay
            as they were drawn last.
        label: What the pose is, e.g. `recorded, 3.2 s`.
    """

    positions: dict[str, _Finite] = Field(min_length=1, max_length=_MOST_JOINTS)
    label: str = Field(default="", max_length=80)


class LayersRequest(_Body):
    """What to lay over the robots.

    Attributes:
        shown: Names of layers; everything else is hidden.
    """

    shown: list[str] = Field(max_length=32)


class SchemeRequest(_Body):
    """How the page looks.

    Attributes:
        dark: Whether it is dark.
    """

    dark: bool


class CameraRequest(_Body):
    """From where to look.

    Attributes:
        preset: Name of the place.
        covered: Part of the picture at its left that the page covers by something else.
    """

    preset: str
    covered: float = Field(default=0.0, ge=0.0, le=0.6)


class OpenedRequest(_Body):
    """What a page hides that has just opened.

    Attributes:
        covered: Part of the picture at its left that the page covers by something else.
    """

    covered: float = Field(ge=0.0, le=0.6)


_Wanted = TypeVar("_Wanted", bound=_Body)


@dataclass(frozen=True, slots=True)
class ShownViews:
    """What the sessions see, as another thread than Viser's reaches it.

    Attributes:
        views: The views; only what never changes may be read.
        in_viser: Lets Viser's event loop call something soon.
    """

    views: SceneViews
    in_viser: Callable[[Callable[[], None]], object]


class ViewRoutes:
    """The routes below `/ui` besides those that Viser answers.

    Args:
        shown: What the sessions see.
        find: Returns the session of a connection.
    """

    def __init__(self, shown: ShownViews, find: "FindSession") -> None:
        self._views = shown.views
        self._in_viser = shown.in_viser
        self._find = find

    def routes(self) -> "list[BaseRoute]":
        """Return the routes."""
        return [
            Route("/ui/ghost", self._show_ghost, methods=["POST"]),
            Route("/ui/ghost", self._hide_ghost, methods=["DELETE"]),
            Route("/ui/layers", self._layers, methods=["PUT"]),
            Route("/ui/scheme", self._scheme, methods=["PUT"]),
            Route("/ui/alive", self._alive, methods=["POST"]),
            Route("/ui/camera", self._camera, methods=["POST"]),
            Route("/ui/opened", self._opened, methods=["POST"]),
        ]

    async def _show_ghost(self, request: "Request") -> Response:
        asked = await self._asked(request, GhostRequest)
        if isinstance(asked, Response):
            return asked
        session, wanted = asked
        known = self._views.joint_names()
        unknown = sorted(wanted.positions.keys() - known)
        if unknown:
            detail = (
                f"positions.{unknown[0]}: the drawn robots have no such joint; they "
                f"have {', '.join(sorted(known)) or 'none'}."
            )
            return refused(422, "unknown_joint", detail)
        ghost = Ghost(wanted.positions, wanted.label)
        self._in_viser(lambda: self._views.show_ghost(session.key, ghost))
        return JSONResponse({"shown": True})

    async def _hide_ghost(self, request: "Request") -> Response:
        session = self._find(request)
        if session is None:
            return _no_session()
        self._in_viser(lambda: self._views.show_ghost(session.key, None))
        return JSONResponse({"shown": False})

    async def _layers(self, request: "Request") -> Response:
        asked = await self._asked(request, LayersRequest)
        if isinstance(asked, Response):
            return asked
        session, wanted = asked
        known = (*LAYERS, PUSH)
        unknown = sorted(set(wanted.shown).difference(known))
        if unknown:
            detail = f"shown: there is no layer '{unknown[0]}'; {_among(known)}."
            return refused(422, "unknown_layer", detail)
        self._in_viser(lambda: self._views.choose(session.key, wanted.shown))
        return JSONResponse({"shown": wanted.shown})

    async def _scheme(self, request: "Request") -> Response:
        asked = await self._asked(request, SchemeRequest)
        if isinstance(asked, Response):
            return asked
        session, wanted = asked
        self._in_viser(lambda: self._views.paint(session.key, is_dark=wanted.dark))
        return JSONResponse({"dark": wanted.dark})

    async def _alive(self, request: "Request") -> Response:
        session = self._find(request)
        if session is None:
            return _no_session()
        self._in_viser(lambda: self._views.alive(session.key))
        return JSONResponse({})

    async def _camera(self, request: "Request") -> Response:
        asked = await self._asked(request, CameraRequest)
        if isinstance(asked, Response):
            return asked
        session, wanted = asked
        if wanted.preset not in PRESETS:
            detail = f"preset: there is no '{wanted.preset}'; {_among(PRESETS)}."
            return refused(422, "unknown_preset", detail)
        preset, covered = wanted.preset, wanted.covered
        self._in_viser(lambda: self._views.look(session.key, preset, covered))
        return JSONResponse({"preset": wanted.preset})

    async def _opened(self, request: "Request") -> Response:
        asked = await self._asked(request, OpenedRequest)
        if isinstance(asked, Response):
            return asked
        session, wanted = asked
        self._in_viser(lambda: self._views.opened(session.key, wanted.covered))
        return JSONResponse({"covered": wanted.covered})

    async def _asked(
        self, request: "Request", kind: type[_Wanted]
    ) -> "tuple[Session, _Wanted] | Response":
        """Return whose request it is and its body, or what refuses it."""
        session = self._find(request)
        if session is None:
            return _no_session()
        wanted = await _read(request, kind)
        return wanted if isinstance(wanted, Response) else (session, wanted)


def _among(names: Iterable[str]) -> str:
    return f"choose among {', '.join(names)}"


async def _read(request: "Request", kind: type[_Wanted]) -> _Wanted | Response:
    """Return the body of a request, or the refusal that says what is wrong with it."""
    try:
        return kind.model_validate_json(await request.body())
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"]) or "the body"
        return refused(422, "invalid_request", f"{place}: {first['msg']}.")


def _no_session() -> Response:
    return refused(401, "no_session", "Log in first.")
