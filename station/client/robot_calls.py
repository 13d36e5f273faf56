"""The routes of one arm as values; see `calls`."""

from collections.abc import Mapping
from typing import Literal
from urllib.parse import quote

from pydantic import BaseModel

from station.client.calls import PREFIX, Call
from station.wire import (
    ArmLog,
    ArmModel,
    ArmReport,
    Arms,
    Faults,
    FrankaState,
    GuidingRequest,
    Recoveries,
    Recovery,
    RecoveryRequest,
    UserStopRequest,
)

Restart = Literal["none", "previous"]


def robots() -> Call[Arms]:
    """Ask for all arms."""
    return Call("GET", f"{PREFIX}/robots", Arms)


def state(arm_id: str) -> Call[FrankaState]:
    """Ask for an arm's whole state."""
    return Call("GET", _path(arm_id, "state"), FrankaState)


def model(arm_id: str, frame: str) -> Call[ArmModel]:
    """Ask what an arm's model says."""
    path = f"{_path(arm_id, 'model')}?frame={quote(frame, safe='')}"
    return Call("GET", path, ArmModel)


def errors(arm_id: str) -> Call[ArmReport]:
    """Ask for an arm's mode and errors."""
    return Call("GET", _path(arm_id, "errors"), ArmReport)


def recover(arm_id: str, restart: Restart) -> Call[Recovery]:
    """Ask to clear an arm's errors."""
    body = RecoveryRequest(restart=restart).model_dump_json().encode()
    path = _path(arm_id, "error_recovery")
    return Call("POST", path, Recovery, body, patience=5.0)


def recover_all(restart: Restart) -> Call[Recoveries]:
    """Ask to clear the errors of all arms."""
    body = RecoveryRequest(restart=restart).model_dump_json().encode()
    path = f"{PREFIX}/robots/error_recovery"
    return Call("POST", path, Recoveries, body, patience=5.0)


def log(arm_id: str) -> Call[ArmLog]:
    """Ask for the last cycles before the last error of an arm."""
    return Call("GET", _path(arm_id, "log"), ArmLog)


def faults(arm_id: str) -> Call[Faults]:
    """Ask what was made to go wrong."""
    return Call("GET", _path(arm_id, "faults"), Faults)


def clear_faults(arm_id: str) -> Call[Faults]:
    """Ask to end what was made to go wrong."""
    return Call("DELETE", _path(arm_id, "faults"), Faults)


def guiding(arm_id: str, *, pressed: bool) -> Call[ArmReport]:
    """Ask to hold or let go of the guiding buttons."""
    return send("POST", arm_id, "guiding", GuidingRequest(pressed=pressed))


def user_stop(arm_id: str, *, pressed: bool) -> Call[ArmReport]:
    """Ask to press or release the user stop."""
    return send("POST", arm_id, "user_stop", UserStopRequest(pressed=pressed))


def act(arm_id: str, what: Literal["connect", "disconnect"]) -> Call[ArmReport]:
    """Ask to connect to an arm or to give it up."""
    return Call("POST", _path(arm_id, what), ArmReport)


def send(
    method: str, arm_id: str, what: str, body: BaseModel | Mapping[str, object]
) -> Call[ArmReport]:
    """Ask for a setting, a push or a fault.

    Args:
        method: HTTP method.
        arm_id: The arm.
        what: Last part of the route.
        body: What to send.
    """
    content = body if isinstance(body, BaseModel) else _Body.model_validate(body)
    sent = content.model_dump_json(exclude_unset=True).encode()
    return Call(method, _path(arm_id, what), ArmReport, sent)


class _Body(BaseModel):
    model_config = {"extra": "allow", "allow_inf_nan": False}


def _path(arm_id: str, rest: str) -> str:
    return f"{PREFIX}/robots/{quote(arm_id, safe='')}/{rest}"
