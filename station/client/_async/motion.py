"""Motions in one call: joints, named poses and poses of the end effector."""

import asyncio
import math
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

from station.client._async.goal_handle import AsyncGoalHandle
from station.client.claims import in_the_way
from station.client.errors import MotionError
from station.client.joint_goals import joint_positions, trajectory_goal
from station.client.poses import Pose, Target, check_name
from station.wire import ControllerSample, ControllerState

if TYPE_CHECKING:
    from station.client._async.station_client import AsyncStationClient

POLL = 0.05
"""How often a moving end effector is looked at, and told to go on [s]."""
HEARTBEAT = 1.0
"""How long the end effector goes on when this program ends [s]."""
BLOCKED = 1.0
"""How long an obstacle may keep the end effector before the motion is given up [s]."""
NEAR = 1e-3
"""Largest distance of an end effector that has arrived [m], and of its quaternion."""
_TRAJECTORY = "/JointTrajectoryController"
_CARTESIAN = "/CartesianStreamingController"


async def start_move(
    client: "AsyncStationClient",
    target: Target,
    *,
    duration: float | None = None,
    controller: str = "",
) -> AsyncGoalHandle:
    """Begin a motion of joints; see `AsyncStationClient.start_move`.

    Args:
        client: The station.
        target: Name of a pose, one position per joint, or positions by joint.
        duration: How long the motion takes [s]; a calm one when None.
        controller: A trajectory controller; found when empty.

    Raises:
        ApiError: The station refuses.
        MotionError: No such controller is loaded, or a joint is unknown.
        UnknownPoseError: There is no such pose.
    """
    if isinstance(target, str):
        check_name(target)
    if not controller:
        controller = await running_controller(client, _TRAJECTORY)
    here = await client.query_state(controller)
    values = joint_positions(target, here.name, here.position)
    goal = trajectory_goal(here.name, here.position, values, duration)
    return AsyncGoalHandle(
        client, controller, await client.submit_goal(controller, goal)
    )


async def move_to(
    client: "AsyncStationClient",
    target: Target | Pose,
    duration: float | None,
    timeout: float | None,
) -> None:
    """Move the arm and wait until it is there.

    Args:
        client: The client.
        target: Name of a pose, positions of joints, or a `Pose` of the end effector.
        duration: How long a motion of joints takes [s]; a calm one when None.
        timeout: Longest wait [s]; None waits for ever.

    Raises:
        MotionError: The arm did not arrive, and why.
        ValueError: A motion to a `Pose` was given a duration.
    """
    if not isinstance(target, Pose):
        goal = await start_move(client, target, duration=duration, controller="")
        await goal.wait(timeout)
        return
    if duration is not None:
        raise ValueError(
            "A motion to a Pose takes no duration; the limits of its controller "
            "say how fast it is."
        )
    await move_to_pose(client, target, timeout)


async def move_to_pose(
    client: "AsyncStationClient", pose: Pose, timeout: float | None = None
) -> None:
    """Move the end effector to a pose and wait until it is there.

    Args:
        client: The station.
        pose: The pose.
        timeout: Longest motion [s]; None waits for ever.

    Raises:
        ApiError: The station refuses.
        MotionError: The arm waits at an obstacle, or did not arrive in time.
    """
    name = await running_controller(client, _CARTESIAN)
    sample = await _first_sample(client, name)
    orientation = pose.orientation or [value or 0.0 for value in sample.desired[3:]]
    target = [*pose.position, *orientation]
    deadline = None if timeout is None else time.monotonic() + timeout
    blocked_since: float | None = None
    while not _is_near(sample, target):
        await client.command(name, target, timeout=HEARTBEAT)
        await asyncio.sleep(POLL)
        sample, now = await client.controller_state(name), time.monotonic()
        obstacle = str(sample.published.get("state", {}).get("obstacle", "none"))
        blocked_since = None if obstacle == "none" else blocked_since or now
        if blocked_since is not None and now - blocked_since > BLOCKED:
            message = str(sample.published["state"].get("message", obstacle))
            raise MotionError(f"The end effector cannot get there. {message}")
        if deadline is not None and now > deadline:
            raise MotionError(f"The end effector did not arrive within {timeout} s.")


async def running_controller(client: "AsyncStationClient", kind: str) -> str:
    """Return a controller of a kind that runs; start one when none does.

    Controllers that command the same joints are stopped.

    Args:
        client: The station.
        kind: End of the controller's type.

    Raises:
        ApiError: The station refuses.
        MotionError: No such controller is loaded.
    """
    listed = await client.controllers()
    found = [c for c in listed if c.type.endswith(kind)]
    if not found:
        raise MotionError(
            f"No {kind.lstrip('/')} is loaded, and no other controller can do this.",
            "Load one: `station load_controller NAME FILE`.",
        )
    # By positions the arm itself keeps to the way, whatever it carries.
    found.sort(key=lambda c: (c.state != "running", not c.type.startswith("position_")))
    chosen = found[0]
    running = {c.name: _claims(c) for c in listed if c.state == "running"}
    running.pop(chosen.name, None)
    holders = in_the_way(_claims(chosen), running)
    start = [] if chosen.state == "running" else [chosen.name]
    if start or holders:
        await client.switch_controllers(start=start, stop=holders)
    return chosen.name


def _claims(controller: ControllerState) -> list[str]:
    return [name for claim in controller.claimed_resources for name in claim.resources]


async def _first_sample(client: "AsyncStationClient", name: str) -> ControllerSample:
    """Return a sample of a controller that has just been started."""
    sample = await client.controller_state(name)
    while len(sample.desired) < 7 or None in sample.desired:
        await asyncio.sleep(POLL)
        sample = await client.controller_state(name)
    return sample


def _is_near(sample: ControllerSample, target: Sequence[float]) -> bool:
    """Return whether position and orientation are there; q and -q are the same."""
    actual = [math.nan if value is None else value for value in sample.actual]
    same = math.dist(actual[3:], target[3:])
    opposite = math.dist(actual[3:], [-value for value in target[3:]])
    return math.dist(actual[:3], target[:3]) < NEAR and min(same, opposite) < NEAR
