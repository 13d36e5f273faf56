"""The REST interface of Desk, as far as programs use it to unlock an arm.

There are two interfaces with one state: `/api` of the FR3's system 5, which takes a
name and a password with every request, and `/admin/api` and `/desk/api` of the Panda
and of Desk's own pages, which take a cookie. Requests that change something carry the
control token. Any name and any password will do: there is no real robot.
"""

import asyncio
import base64
import json
import secrets
from collections.abc import Awaitable, Callable, Mapping
from concurrent.futures import Future
from contextlib import suppress
from typing import Any

from starlette.applications import Starlette
from starlette.requests import HTTPConnection, Request
from starlette.responses import JSONResponse, PlainTextResponse, Response
from starlette.routing import BaseRoute, Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from station.core.errors import StationError
from station.hw.franka.fci.desk.desk_state import (
    LONGEST_WAIT,
    Desk,
    DeskRefusalError,
    InvalidArgumentError,
    load_of,
)

JOINTS_PERIOD = 0.1
"""Time between two messages with the joints' positions [s]."""
_LOOK = 0.05
_CARRIED_OUT = 2.0
_ARM_TYPES = {"panda": "Panda", "fr3": "FR3"}
_DONE = Response(status_code=204)
Answer = Any
_Handler = Callable[[Desk, "Call"], Answer]  # or an awaitable of one


class Call:
    """One request with its body and its control token.

    Args:
        request: The request.
        body: Body of the request.

    Attributes:
        path: Parts of the path, by their names in the route.
        token: The control token; empty without one.
    """

    def __init__(self, request: Request, body: bytes) -> None:
        self.request, self._body = request, body
        self.token = request.headers.get("x-control-token", "")

    def json(self) -> Mapping[str, Any]:
        """Return the fields of the body, which is a JSON object.

        Raises:
            InvalidArgumentError: The body is something else.
        """
        found = self.value() if self._body else {}
        if not isinstance(found, dict):
            raise InvalidArgumentError("The body is no object.")
        return found

    def value(self) -> object:
        """Return the body as JSON.

        Raises:
            InvalidArgumentError: The body is not JSON.
        """
        try:
            return json.loads(self._body)
        except ValueError as error:
            raise InvalidArgumentError(f"The body is no JSON: {error}.") from error

    def text(self, name: str) -> str:
        """Return a field of the body as text; empty without such a field."""
        return str(self.json().get(name) or "")


async def _after(change: Future[None] | None, answer: Answer = None) -> Answer:
    """Wait until the arm has carried out a change; return the answer, `{}` if None.

    Raises:
        DeskRefusalError: The arm refuses the change, or does not answer.
    """
    if change is not None:
        try:
            async with asyncio.timeout(_CARRIED_OUT):
                await asyncio.wrap_future(change)
        except (StationError, TimeoutError) as error:
            reason = str(error) or f"no answer within {_CARRIED_OUT:g} s"
            raise DeskRefusalError(f"The robot has not done it: {reason}") from error
    return {} if answer is None else answer


def _shown(desk: Desk) -> dict[str, object]:
    """Return the answers to all requests that read, by their paths."""
    # The control token and the end effector as both interfaces show them.
    token, brakes = desk.token, "Locked" if desk.are_brakes_closed else "Unlocked"
    new = {} if token is None else {"owner": token.owner, "tokenId": token.number}
    old = token and {
        "id": token.number,
        "requestedBy": token.owner,
        "ownedBy": token.owner,
    }
    active = desk.find_profile(desk.active)
    params = {**active["inertial"], "transformation": active["tcp"]}
    tool = {"name": active.get("endEffector", "Other"), "params": params}
    return {
        "/api/system": {
            "status": "Started",
            "operatingMode": {"status": desk.mode},
            "controlSerialNumber": "simulated",
            "cloud": {"status": "Disconnected"},
        },
        "/api/system/operating-mode": {"status": desk.mode},
        "/api/system/control-token": new,
        "/api/arm": {"status": "Connected", "armType": _ARM_TYPES[desk.kind]},
        "/api/arm/joints": [{"id": i, "brakeStatus": brakes} for i in range(1, 8)],
        "/api/fci": {"status": "Active" if desk.is_fci_active else "Inactive"},
        "/api/safety/recovery": {},
        "/api/safety/self-tests": {"status": "OK", "remaining": 86_400},
        "/api/configuration": {"endEffectorConfiguration": {"endEffector": tool}},
        "/admin/api/system-status": {
            "controlToken": {"activeToken": old},
            "derived": {"operatingMode": desk.mode},
            "safety": {
                "brakeState": [brakes] * 7,
                "recoverableErrors": {"td2Timeout": False},
                "safetyControllerStatus": "Idle",
            },
        },
        "/admin/api/control-token": {
            "activeToken": old,
            "fciActive": desk.is_fci_active,
        },
        "/admin/api/end-effector/profiles": [*map(desk.find_profile, desk.profiles)],
        "/admin/api/end-effector/profiles/active": active,
    }


def _show(desk: Desk, call: Call) -> Answer:
    return _shown(desk)[call.request.url.path]


def _change_mode(desk: Desk, call: Call) -> Answer:
    return _after(desk.change_mode(call.text("desiredOperatingMode")), _DONE)


def _mode_of_path(desk: Desk, call: Call) -> Answer:
    return _after(desk.change_mode(call.request.path_params["mode"]))


async def _take(desk: Desk, call: Call) -> Answer:
    try:
        # In this order NaN becomes the longest wait.
        timeout = min(LONGEST_WAIT, float(call.json().get("timeout") or 0.0))
    except (TypeError, ValueError) as error:
        raise InvalidArgumentError(f"The timeout is no number: {error}.") from error
    token = desk.request_control(call.text("owner"))
    while desk.token is not token:
        is_over = desk.now() >= token.since + timeout
        # Control that nobody knows of would be in the way of all others.
        if is_over or await call.request.is_disconnected():
            desk.release_control(token.secret)
            holder = "" if desk.token is None else desk.token.owner
            raise DeskRefusalError(f"{holder} has control.", 424, "Timeout")
        await asyncio.sleep(_LOOK)
    return {"token": token.secret, "tokenId": token.number}


def _release(desk: Desk, call: Call) -> Answer:
    desk.release_control(call.token)
    return _DONE


def _brakes(*, closed: bool) -> _Handler:
    return lambda desk, _call: _after(desk.set_brakes(closed=closed))


def _fci(*, active: bool) -> _Handler:
    return lambda desk, _call: _after(desk.set_fci(active=active))


def _say(answer: Mapping[str, object]) -> _Handler:
    return lambda _desk, _call: answer


def _refuse(_desk: Desk, call: Call) -> Answer:
    raise DeskRefusalError(f"A simulated arm has no {call.request.url.path}.")


def _login(_desk: Desk, call: Call) -> Answer:
    if not call.text("login"):
        raise DeskRefusalError("The name is missing.", 401, "Unauthorized")
    return PlainTextResponse(secrets.token_hex(16))


def _old_request(desk: Desk, call: Call) -> Answer:
    is_forced = "force" in call.request.url.query
    token = desk.request_control(call.text("requestedBy"), is_forced=is_forced)
    return {"id": token.number, "token": token.secret}


def _old_release(desk: Desk, call: Call) -> Answer:
    desk.release_control(call.text("token"))
    return {}


def _old_fci(desk: Desk, call: Call) -> Answer:
    desk.check_control(call.text("token"))
    return _after(desk.set_fci(active=call.request.method == "POST"))


def _configure(desk: Desk, call: Call) -> Answer:
    configuration = call.json().get("endEffectorConfiguration")
    told = configuration.get("endEffector") if isinstance(configuration, dict) else None
    if not isinstance(told, dict) or not isinstance(told.get("params"), dict):
        raise DeskRefusalError("endEffectorConfiguration alone can be changed here.")
    params = dict(told["params"])
    profile = {
        "name": "Configured",
        "endEffector": str(told.get("name") or "Other"),
        "deviceId": "ee-no-gripper",
        "tcp": params.pop("transformation", None),
        "inertial": params,
    }
    load_of(profile)
    # This interface knows one end effector, whatever its name was before.
    desk.profiles["ee-configured"] = profile
    return _after(desk.activate_profile("ee-configured"), _DONE)


def _save(desk: Desk, call: Call) -> Answer:
    name = call.request.path_params.get("name")
    profile = desk.save_profile(name, dict(call.json()))
    change = desk.activate_profile(name) if name == desk.active else None
    return _after(change, profile)


def _delete(desk: Desk, call: Call) -> Answer:
    desk.delete_profile(call.request.path_params["name"])
    return _DONE


def _activate(desk: Desk, call: Call) -> Answer:
    return _after(desk.activate_profile(str(call.value())), _DONE)


_WITHOUT_LOGIN = "/admin/api/login"
# Method, path and handler of requests that change something; those of `_CONTROLLED`
# need the control token.
_FREE: tuple[tuple[str, str, _Handler], ...] = (
    ("POST", "/api/system/control-token:take", _take),
    ("POST", "/api/safety/recovery:confirm", _say({})),
    ("POST", "/api/system:reboot", lambda desk, _: _after(desk.reboot(), _DONE)),
    ("POST", "/api/system:shutdown", _refuse),
    ("POST", _WITHOUT_LOGIN, _login),
    ("POST", "/admin/api/logout", _say({})),
    ("POST", "/admin/api/control-token/request", _old_request),
    ("DELETE", "/admin/api/control-token", _old_release),
    ("POST", "/admin/api/control-token/fci", _old_fci),
    ("DELETE", "/admin/api/control-token/fci", _old_fci),
    # Older clients close the brakes without control: an arm at rest harms nobody.
    ("POST", "/desk/api/joints/lock", _brakes(closed=True)),
    ("POST", "/desk/api/robot/close-brakes", _brakes(closed=True)),
    ("POST", "/admin/api/shutdown", _refuse),
    ("POST", "/desk/api/execution", _refuse),
)
_CONTROLLED: tuple[tuple[str, str, _Handler], ...] = (
    ("POST", "/api/system/control-token:release", _release),
    ("POST", "/api/system/operating-mode:change", _change_mode),
    ("POST", "/api/arm/joints:unlock", _brakes(closed=False)),
    ("POST", "/api/arm/joints:lock", _brakes(closed=True)),
    ("POST", "/api/fci:activate", _fci(active=True)),
    ("POST", "/api/fci:deactivate", _fci(active=False)),
    ("POST", "/api/safety/self-tests:execute", _say({"code": "SuccessResponse"})),
    ("PATCH", "/api/configuration", _configure),
    ("POST", "/admin/api/safety/td2-tests/execute", _say({"code": "SuccessResponse"})),
    ("POST", "/admin/api/end-effector/profiles", _save),
    ("PUT", "/admin/api/end-effector/profiles/active", _activate),
    ("PUT", "/admin/api/end-effector/profiles/{name}", _save),
    ("DELETE", "/admin/api/end-effector/profiles/{name}", _delete),
    ("POST", "/desk/api/system/fci", _fci(active=True)),
    ("POST", "/admin/api/reboot", lambda desk, _: _after(desk.reboot())),
    ("POST", "/desk/api/joints/unlock", _brakes(closed=False)),
    ("POST", "/desk/api/robot/open-brakes", _brakes(closed=False)),
    ("POST", "/desk/api/operating-mode/{mode}", _mode_of_path),
    ("POST", "/desk/api/gripper/homing", lambda desk, _: _after(desk.home_gripper())),
)


def _is_known(connection: HTTPConnection) -> bool:
    """Return whether a request carries a name, or the cookie of a login."""
    if connection.cookies.get("authorization"):
        return True
    told = connection.headers.get("authorization", "")
    kind, _, value = told.partition(" ")
    if kind.lower() != "basic":
        return bool(told)  # the cookie's value, which clients of the buttons send
    try:
        return bool(base64.b64decode(value, validate=True).partition(b":")[0])
    except ValueError:
        return False


def _endpoint(
    desk: Desk, handler: _Handler, *, is_controlled: bool
) -> Callable[[Request], Awaitable[Response]]:
    async def answer(request: Request) -> Response:
        try:
            if request.url.path != _WITHOUT_LOGIN and not _is_known(request):
                raise DeskRefusalError("Log in first.", 401, "Unauthorized")
            call = Call(request, await request.body())
            if is_controlled:
                desk.check_control(call.token)
            found = handler(desk, call)
            if isinstance(found, Awaitable):
                found = await found
        except DeskRefusalError as error:
            told = {"code": error.reason, "message": error.message}
            return JSONResponse(told, error.status)
        return found if isinstance(found, Response) else JSONResponse(found)

    return answer


def make_app(desk: Desk) -> Starlette:
    """Return the web application of a Desk."""
    reading = [("GET", path, _show) for path in _shown(desk)]
    routes: list[BaseRoute] = [
        Route(path, _endpoint(desk, handler, is_controlled=is_controlled), methods=[m])
        for table, is_controlled in (((*reading, *_FREE), False), (_CONTROLLED, True))
        for m, path, handler in table
    ]

    async def tell_joints(socket: WebSocket) -> None:
        await socket.send_json({"jointAngles": [*desk.arm.state.q]})
        await asyncio.sleep(JOINTS_PERIOD)

    routes += [
        WebSocketRoute("/desk/api/robot/configuration", _repeat(tell_joints)),
        # Nobody presses a button of a simulated arm: only the end of the client comes.
        WebSocketRoute("/desk/api/navigation/events", _repeat(WebSocket.receive)),
    ]
    return Starlette(routes=routes)


def _repeat(
    step: Callable[[WebSocket], Awaitable[object]],
) -> Callable[[WebSocket], Awaitable[None]]:
    """Return the endpoint of a WebSocket that repeats a step until the client goes."""

    async def serve(socket: WebSocket) -> None:
        if not _is_known(socket):
            await socket.close()
            return
        await socket.accept()
        with suppress(WebSocketDisconnect, RuntimeError):
            while True:
                await step(socket)

    return serve
