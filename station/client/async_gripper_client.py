"""The asynchronous client of one gripper: one method per route."""

from collections.abc import Awaitable, Callable
from typing import Any

from station.client import gripper_calls as calls
from station.client.calls import Call
from station.wire import Gripper, GripperGraspRequest, GripperMoveRequest


class AsyncGripperClient:
    """The gripper of an arm; `AsyncRobotClient.gripper`.

    Homing, move and grasp begin and return at once; `state` tells how far they are.
    Every method raises what the client's own methods raise.

    Args:
        do: Sends a call and returns its answer.
        arm_id: The arm.
    """

    def __init__(self, do: Callable[[Call[Any]], Awaitable[Any]], arm_id: str) -> None:
        self._do = do
        self.arm_id = arm_id

    async def state(self) -> Gripper:
        """Return the state, with the command that is active and the last that ended."""
        answer: Gripper = await self._do(calls.state(self.arm_id))
        return answer

    async def homing(self) -> Gripper:
        """Begin to close and to open all the way."""
        answer: Gripper = await self._do(calls.act(self.arm_id, "homing"))
        return answer

    async def move(self, request: GripperMoveRequest) -> Gripper:
        """Begin to open or close to a width."""
        answer: Gripper = await self._do(calls.move(self.arm_id, request))
        return answer

    async def grasp(self, request: GripperGraspRequest) -> Gripper:
        """Begin to grasp something."""
        answer: Gripper = await self._do(calls.grasp(self.arm_id, request))
        return answer

    async def stop(self) -> Gripper:
        """Stand still and press no more: what is held can fall."""
        answer: Gripper = await self._do(calls.act(self.arm_id, "stop"))
        return answer
