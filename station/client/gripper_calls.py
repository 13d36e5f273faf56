"""The routes of one gripper as values; see `calls`."""

from typing import Literal
from urllib.parse import quote

from pydantic import BaseModel

from station.client.calls import PREFIX, Call
from station.wire import Gripper, GripperGraspRequest, GripperMoveRequest


def state(arm_id: str) -> Call[Gripper]:
    """Ask for the state."""
    return Call("GET", _path(arm_id), Gripper)


def move(arm_id: str, request: GripperMoveRequest) -> Call[Gripper]:
    """Ask to open or close to a width."""
    return _post(arm_id, "move", request)


def grasp(arm_id: str, request: GripperGraspRequest) -> Call[Gripper]:
    """Ask to grasp something."""
    return _post(arm_id, "grasp", request)


def act(arm_id: str, what: Literal["homing", "stop"]) -> Call[Gripper]:
    """Ask for what needs no numbers."""
    return _post(arm_id, what, None)


def _post(arm_id: str, what: str, request: BaseModel | None) -> Call[Gripper]:
    body = None if request is None else request.model_dump_json().encode()
    return Call("POST", f"{_path(arm_id)}/{what}", Gripper, body)


def _path(arm_id: str) -> str:
    return f"{PREFIX}/robots/{quote(arm_id, safe='')}/gripper"
