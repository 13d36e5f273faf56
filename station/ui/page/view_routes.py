"""Requests of the page about its own 3D view. None of them reaches the station.

`POST /ui/ghost` shows a second, translucent robot in the browsers of the session that
asks, e.g. a recorded or a planned pose; `DELETE /ui/ghost` hides it. A ghost is a
picture: no controller hears of it, so a viewer may show one, too. `PUT /ui/layers`
chooses the layers over the robots, `PUT /ui/object` the object that arrows move,
`POST /ui/camera` the place from which to look.
`POST /ui/opened` says how much of the view is hidden by a page that has just opened.
`PUT /ui/scheme` says whether the page is dark, so that its 3D view is, too. A page in
which links can be pulled says with `POST /ui/alive` that it still runs.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Annotated

from pydantic import Field
from starlette.responses import JSONResponse, Response

from station.ui.scene.camera import PRESETS
from station.ui.scene.scene_views import LAYERS, PUSH, Ghost, SceneViews
from station.ui.sessions.sessions import (
    Body,
    FindSession,
    RefusedError,
    SessionRoutes,
)

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.routing import BaseRoute

    from station.ui.sessions.sessions import BrowserSession

_MOST_JOINTS = 128
_Finite = Annotated[float, Field(allow_inf_nan=False)]


class GhostRequest(Body):
    """A pose to show.

    Attributes:
        positions: Joint positions by name [rad] or [m]; joints that are not named stay
            as they were drawn last.
        label: A name of the pose, e.g. `recorded, 3.2 s`.
    """

    positions: dict[str, _Finite] = Field(min_length=1, max_length=_MOST_JOINTS)
    label: str = Field(default="", max_length=80)


class LayersRequest(Body):
    """A choice of layers over the robots.

    Attributes:
        shown: Names of layers; everything else is hidden.
    """

    shown: list[str] = Field(max_length=32)


class ObjectRequest(Body):
    """The object that arrows in the view move.

    Attributes:
        name: Its name; empty for none.
    """

    name: str = Field(max_length=128)


class SchemeRequest(Body):
    """The colour scheme of the page.

    Attributes:
        dark: Whether it is dark.
    """

    dark: bool


class CameraRequest(Body):
    """A place from which to look.

    Attributes:
        preset: Name of the place.
        covered: Share of the picture, at its left, that the page covers, 0 to 0.6.
    """

    preset: str
    covered: float = Field(default=0.0, ge=0.0, le=0.6)


class OpenedRequest(Body):
    """The part of the 3D view that a page hides when it opens.

    Attributes:
        covered: Share of the picture, at its left, that the page covers, 0 to 0.6.
    """

    covered: float = Field(ge=0.0, le=0.6)


@dataclass(frozen=True, slots=True)
class ShownViews:
    """The views of all sessions, for threads other than Viser's.

    Attributes:
        views: The views; only attributes that never change may be read.
        in_viser: Schedules a call of a function in Viser's event loop.
    """

    views: SceneViews
    in_viser: Callable[[Callable[[], None]], object]


class ViewRoutes:
    """The routes below `/ui` besides those that Viser answers.

    Args:
        shown: The views of all sessions.
        find: Returns the session of a connection.
    """

    def __init__(self, shown: ShownViews, find: FindSession) -> None:
        self._views = shown.views
        self._in_viser = shown.in_viser
        self._find = find

    def routes(self) -> "list[BaseRoute]":
        """Return the routes."""
        make = SessionRoutes(self._find)
        return [
            make.route_of("POST", "/ui/ghost", GhostRequest, self._show_ghost),
            make.route("DELETE", "/ui/ghost", self._hide_ghost),
            make.route_of("PUT", "/ui/layers", LayersRequest, self._layers),
            make.route_of("PUT", "/ui/object", ObjectRequest, self._grip),
            make.route_of("PUT", "/ui/scheme", SchemeRequest, self._scheme),
            make.route("POST", "/ui/alive", self._alive),
            make.route_of("POST", "/ui/camera", CameraRequest, self._camera),
            make.route_of("POST", "/ui/opened", OpenedRequest, self._opened),
        ]

    async def _show_ghost(
        self, session: "BrowserSession", wanted: GhostRequest
    ) -> Response:
        known = self._views.joint_names()
        unknown = sorted(wanted.positions.keys() - known)
        if unknown:
            detail = (
                f"positions.{unknown[0]}: the drawn robots have no such joint; they "
                f"have {', '.join(sorted(known)) or 'none'}."
            )
            raise RefusedError(422, "unknown_joint", detail)
        ghost = Ghost(wanted.positions, wanted.label)
        self._in_viser(partial(self._views.show_ghost, session.key, ghost))
        return JSONResponse({"shown": True})

    async def _hide_ghost(
        self, session: "BrowserSession", _request: "Request"
    ) -> Response:
        self._in_viser(partial(self._views.show_ghost, session.key, None))
        return JSONResponse({"shown": False})

    async def _layers(
        self, session: "BrowserSession", wanted: LayersRequest
    ) -> Response:
        known = (*LAYERS, PUSH)
        unknown = sorted(set(wanted.shown).difference(known))
        if unknown:
            detail = f"shown: there is no layer '{unknown[0]}'; {_among(known)}."
            raise RefusedError(422, "unknown_layer", detail)
        self._in_viser(partial(self._views.choose, session.key, wanted.shown))
        return JSONResponse({"shown": wanted.shown})

    async def _grip(self, session: "BrowserSession", wanted: ObjectRequest) -> Response:
        self._in_viser(partial(self._views.grip, session.key, wanted.name))
        return JSONResponse({"name": wanted.name})

    async def _scheme(
        self, session: "BrowserSession", wanted: SchemeRequest
    ) -> Response:
        self._in_viser(partial(self._views.paint, session.key, is_dark=wanted.dark))
        return JSONResponse({"dark": wanted.dark})

    async def _alive(self, session: "BrowserSession", _request: "Request") -> Response:
        self._in_viser(partial(self._views.alive, session.key))
        return JSONResponse({})

    async def _camera(
        self, session: "BrowserSession", wanted: CameraRequest
    ) -> Response:
        if wanted.preset not in PRESETS:
            detail = f"preset: there is no '{wanted.preset}'; {_among(PRESETS)}."
            raise RefusedError(422, "unknown_preset", detail)
        preset, covered = wanted.preset, wanted.covered
        self._in_viser(partial(self._views.look, session.key, preset, covered))
        return JSONResponse({"preset": preset})

    async def _opened(
        self, session: "BrowserSession", wanted: OpenedRequest
    ) -> Response:
        self._in_viser(partial(self._views.opened, session.key, wanted.covered))
        return JSONResponse({"covered": wanted.covered})


def _among(names: Iterable[str]) -> str:
    return f"choose among {', '.join(names)}"
