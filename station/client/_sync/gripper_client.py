# Generated from _async/gripper_client.py by tools/generate_client.py.
"""The client of one gripper."""

import time

from station.client._sync.connection import Connection
from station.client.errors import MotionError
from station.client.routes import segment
from station.wire import (
    GraspEpsilon,
    Gripper,
    GripperGraspRequest,
    GripperMoveRequest,
)

POLL = 0.05
"""How often a gripper that moves is looked at [s]."""


class GripperClient:
    """The gripper of an arm: `client.robot(arm_id).gripper`.

    Homing, move and grasp begin and return at once; `state` tells how far they are.
    `open` and `close` wait until the fingers are there.
    Every method raises what the station client's own methods raise.

    Args:
        connection: The connection to the station.
        arm_id: The arm.
    """

    def __init__(self, connection: Connection, arm_id: str) -> None:
        self._connection = connection
        self._path = f"/robots/{segment(arm_id)}/gripper"
        self.arm_id = arm_id

    def state(self) -> Gripper:
        """Return the state, with the active command and the last that ended."""
        return self._connection.get(self._path, Gripper)

    def open(
        self, width: float | None = None, *, speed: float = 0.1, timeout: float = 10.0
    ) -> Gripper:
        """Open, or close without force, to a width and wait until it is reached.

        Args:
            width: Distance of the fingers [m]; the largest one when None.
            speed: How fast it changes, at most 0.4 [m/s].
            timeout: Longest wait [s].

        Raises:
            MotionError: The width was not reached, and why.
        """
        if width is None:
            width = (self.state()).max_width
        request = GripperMoveRequest(width=width, speed=speed)
        return self._finish(self.move(request), timeout)

    def close(
        self, force: float = 20.0, *, speed: float = 0.1, timeout: float = 10.0
    ) -> Gripper:
        """Close until the fingers meet something, or each other, and press.

        Args:
            force: What each finger presses with, 0.1 to 140 [N].
            speed: How fast the width changes, at most 0.4 [m/s].
            timeout: Longest wait [s].

        Returns:
            The state; its `width` is that of the object, 0 without one.

        Raises:
            MotionError: The fingers did not close, and why.
        """
        # Closed fingers are a hair beyond zero or not, hence the inner tolerance.
        whatever = GraspEpsilon(inner=0.005, outer=(self.state()).max_width)
        request = GripperGraspRequest(
            width=0.0, force=force, speed=speed, epsilon=whatever
        )
        return self._finish(self.grasp(request), timeout)

    def homing(self) -> Gripper:
        """Begin to close and to open the gripper all the way."""
        return self._connection.send("POST", f"{self._path}/homing", Gripper)

    def move(self, request: GripperMoveRequest) -> Gripper:
        """Begin to open or close the gripper to a width."""
        path = f"{self._path}/move"
        return self._connection.send("POST", path, Gripper, request)

    def grasp(self, request: GripperGraspRequest) -> Gripper:
        """Begin to grasp an object."""
        path = f"{self._path}/grasp"
        return self._connection.send("POST", path, Gripper, request)

    def stop(self) -> Gripper:
        """Hold the fingers still without force: a grasped object can fall."""
        return self._connection.send("POST", f"{self._path}/stop", Gripper)

    def _finish(self, begun: Gripper, timeout: float) -> Gripper:
        """Wait until the command that has just begun has ended well.

        Raises:
            MotionError: It has not.
        """
        command, state = begun.command, begun
        deadline = time.monotonic() + timeout
        while command and state.command and state.command.id == command.id:
            if time.monotonic() > deadline:
                raise MotionError(f"The gripper needed more than {timeout} s.")
            time.sleep(POLL)
            state = self.state()
        last = state.last
        if last is None or last.status != "succeeded":
            raise MotionError(
                f"The gripper did not succeed: {last.message if last else 'no answer'}"
            )
        return state
