"""The gripper of an arm: homing, move, grasp, stop and state of franka_gripper."""

from fastapi import APIRouter

from station import wire
from station.api import answers, requests
from station.api.dependencies import GrippersDep, Operator, Viewer
from station.api.json_route import JsonRoute
from station.api.routes.problems import problems

router = APIRouter(
    prefix="/robots/{arm_id}/gripper",
    tags=["robots"],
    dependencies=[Viewer],
    route_class=JsonRoute,
)
_MOVE = problems(404, 409, 413, 422, 423, 503)


@router.get("", responses=problems(404, 503))
def get_gripper(arm_id: str, grippers: GrippersDep) -> wire.Gripper:
    """Return the gripper's state: its activity, and how the last command ended."""
    return answers.gripper(arm_id, grippers.state(arm_id))


@router.post("/homing", status_code=202, dependencies=[Operator], responses=_MOVE)
def home_gripper(arm_id: str, grippers: GrippersDep) -> wire.Gripper:
    """Begin to close and to open the gripper all the way; answers at once."""
    return answers.gripper(arm_id, grippers.homing(arm_id))


@router.post("/move", status_code=202, dependencies=[Operator], responses=_MOVE)
def move_gripper(
    arm_id: str, request: wire.GripperMoveRequest, grippers: GrippersDep
) -> wire.Gripper:
    """Begin to open or close the gripper to a width; answers at once.

    It ends the command before, as every command of a gripper does.
    """
    found = grippers.move(arm_id, request.width, request.speed)
    return answers.gripper(arm_id, found)


@router.post("/grasp", status_code=202, dependencies=[Operator], responses=_MOVE)
def grasp(
    arm_id: str, request: wire.GripperGraspRequest, grippers: GrippersDep
) -> wire.Gripper:
    """Begin to grasp an object; answers at once.

    The fingers close, or open when they are too close for the width, until an object
    stops them. When its width is the expected one, they press it with the force.
    """
    found = grippers.grasp(arm_id, requests.grasp(request))
    return answers.gripper(arm_id, found)


@router.post("/stop", dependencies=[Operator], responses=problems(404, 413, 422, 503))
def stop_gripper(arm_id: str, grippers: GrippersDep) -> wire.Gripper:
    """Hold the fingers still without force: a grasped object can fall.

    Possible at any time, also while the station is stopped.
    """
    return answers.gripper(arm_id, grippers.stop(arm_id))
