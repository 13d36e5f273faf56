"""The joints of the last cycle."""

from fastapi import APIRouter

from station.api import answers
from station.api.dependencies import StationDep, Viewer
from station.api.routes.problems import problems
from station.wire import JointStates

router = APIRouter(tags=["robot"], dependencies=[Viewer])


@router.get("/joint_states", responses=problems(503))
async def joint_states(station: StationDep) -> JointStates:
    """Return positions, velocities and efforts of all joints, of the same cycle."""
    return answers.joint_states(station.latest(), station.joint_names)
