"""The client of one gripper."""

from station.client._async.connection import AsyncConnection
from station.client.routes import segment
from station.wire import Gripper, GripperGraspRequest, GripperMoveRequest


class AsyncGripperClient:
    """The gripper of an arm: `client.robot(arm_id).gripper`.

    Homing, move and grasp begin and return at once; `state` tells how far they are.
    Every method raises what the station client's own methods raise.

    Args:
        connection: The connection to the station.
        arm_id: The arm.
    """

    def __init__(self, connection: AsyncConnection, arm_id: str) -> None:
        self._connection = connection
        self._path = f"/robots/{segment(arm_id)}/gripper"
        self.arm_id = arm_id

    async def state(self) -> Gripper:
        """Return the state, with the active command and the last that ended."""
        return await self._connection.get(self._path, Gripper)

    async def homing(self) -> Gripper:
        """Begin to close and to open the gripper all the way."""
        return await self._connection.send("POST", f"{self._path}/homing", Gripper)

    async def move(self, request: GripperMoveRequest) -> Gripper:
        """Begin to open or close the gripper to a width."""
        path = f"{self._path}/move"
        return await self._connection.send("POST", path, Gripper, request)

    async def grasp(self, request: GripperGraspRequest) -> Gripper:
        """Begin to grasp an object."""
        path = f"{self._path}/grasp"
        return await self._connection.send("POST", path, Gripper, request)

    async def stop(self) -> Gripper:
        """Hold the fingers still without force: a grasped object can fall."""
        return await self._connection.send("POST", f"{self._path}/stop", Gripper)
