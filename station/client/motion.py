"""Motions in one call, of joints, to named poses and to poses of the end effector."""

import math
import time
from collections.abc import Iterable, Mapping, Sequence

from pydantic import JsonValue, TypeAdapter

from station.client.connection import Sleep
from station.client.controllers import AsyncControllersClient, AsyncGoalHandle
from station.client.errors import MotionError
from station.client.poses import (
    POSES,
    Pose,
    Target,
    check_name,
    joint_positions,
    trajectory_goal,
)
from station.wire import ControllerSample, ControllerState

POLL = 0.05
"""Period at which a moving end effector is observed and commanded [s]."""
HEARTBEAT = 1.0
"""Timeout of a set-point: how long the end effector goes on after this program ends
[s]."""
BLOCKED = 1.0
"""Longest wait of the end effector at an obstacle before the motion is given up [s]."""
NEAR = 1e-3
"""Largest distance of an end effector from its target that counts as arrived [m]; also
for its quaternion."""
_TRAJECTORY = "/JointTrajectoryController"
_CARTESIAN = "/CartesianStreamingController"


async def start_move(
    client: AsyncControllersClient,
    target: Target | Pose,
    *,
    duration: float | None = None,
    controller: str = "",
    plan: bool = False,
    certificate: str | None = None,
) -> AsyncGoalHandle:
    """Begin a motion of joints; see `AsyncStationClient.start_move`.

    Args:
        client: The station.
        target: Name of a pose, one position per joint, or positions by joint; with
            `plan` also a `Pose` of the end effector.
        duration: Duration of the motion [s]; None for a slow motion.
        controller: A trajectory controller; empty finds one.
        plan: Whether to plan a path without collisions.
        certificate: Certificate of a rehearsal of this motion; None without one.

    Raises:
        ApiError: The station refuses.
        MotionError: No such controller is loaded, or a joint is unknown.
        UnknownPoseError: The pose is unknown.
        ValueError: A `Pose` was given without `plan`, or a certificate with it.
    """
    if plan and certificate is not None:
        raise ValueError("A path that is planned now has not been rehearsed.")
    if isinstance(target, Pose) and not plan:
        raise ValueError("A Pose needs plan=True; move_to goes there straight.")
    if isinstance(target, str) and not plan:
        check_name(target)
    if not controller:
        controller = await running_controller(client, _TRAJECTORY)
    # Only the station knows the names of other poses, which the robot defines.
    if isinstance(target, Pose) or (isinstance(target, str) and target not in POSES):
        return await _start_planned(client, controller, target)
    here = await client.query_state(controller)
    values = joint_positions(target, here.name, here.position)
    if plan:
        wanted = dict(zip(here.name, values, strict=True))
        return await _start_planned(client, controller, wanted)
    goal = trajectory_goal(here.name, here.position, values, duration)
    return await client.start_goal(controller, goal, certificate=certificate)


async def _start_planned(
    client: AsyncControllersClient,
    controller: str,
    target: Mapping[str, float] | Pose | str,
) -> AsyncGoalHandle:
    found = await client.plan(controller, target)
    goal = TypeAdapter(dict[str, JsonValue]).validate_python(found.goal)
    return await client.start_goal(controller, goal)


async def move_to(
    client: AsyncControllersClient,
    target: Target | Pose,
    duration: float | None,
    timeout: float | None,
    sleep: Sleep,
    *,
    plan: bool = False,
) -> None:
    """Move the arm and wait until it has arrived.

    Args:
        client: The client.
        target: Name of a pose, positions of joints, or a `Pose` of the end effector.
        duration: Duration of a motion of joints [s]; None for a slow motion.
        timeout: Longest wait [s]; None waits for ever.
        sleep: Function that waits for a time [s].
        plan: Whether to plan a path of the joints without collisions.

    Raises:
        MotionError: The arm did not arrive; the message has the reason.
        ValueError: A motion to a `Pose` was given a duration.
    """
    if plan or not isinstance(target, Pose):
        goal = await start_move(client, target, duration=duration, plan=plan)
        await goal.wait(timeout)
        return
    if duration is not None:
        raise ValueError(
            "A motion to a Pose takes no duration; the limits of its controller "
            "say how fast it is."
        )
    await move_to_pose(client, target, timeout, sleep)


async def move_to_pose(
    client: AsyncControllersClient, pose: Pose, timeout: float | None, sleep: Sleep
) -> None:
    """Move the end effector to a pose and wait until it has arrived.

    Args:
        client: The station.
        pose: The pose.
        timeout: Longest motion [s]; None waits for ever.
        sleep: Function that waits for a time [s].

    Raises:
        ApiError: The station refuses.
        MotionError: The arm waits at an obstacle, or did not arrive in time.
    """
    name = await running_controller(client, _CARTESIAN)
    sample = await _first_sample(client, name, sleep)
    orientation = pose.orientation or [value or 0.0 for value in sample.desired[3:]]
    target = [*pose.position, *orientation]
    deadline = None if timeout is None else time.monotonic() + timeout
    blocked_since: float | None = None
    while not _is_near(sample, target):
        await client.command(name, target, timeout=HEARTBEAT)
        await sleep(POLL)
        sample, now = await client.controller_state(name), time.monotonic()
        obstacle = str(sample.published.get("state", {}).get("obstacle", "none"))
        blocked_since = None if obstacle == "none" else blocked_since or now
        if blocked_since is not None and now - blocked_since > BLOCKED:
            message = str(sample.published["state"].get("message", obstacle))
            raise MotionError(f"The end effector cannot get there. {message}")
        if deadline is not None and now > deadline:
            raise MotionError(f"The end effector did not arrive within {timeout} s.")


async def running_controller(client: AsyncControllersClient, kind: str) -> str:
    """Return a running controller of a kind; start one if none runs.

    A start stops controllers that command the same joints.

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
    # Prefer position control: the arm itself keeps to the path, whatever it carries.
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


async def _first_sample(
    client: AsyncControllersClient, name: str, sleep: Sleep
) -> ControllerSample:
    """Return a sample of a controller that has just been started."""
    sample = await client.controller_state(name)
    while len(sample.desired) < 7 or None in sample.desired:
        await sleep(POLL)
        sample = await client.controller_state(name)
    return sample


def _is_near(sample: ControllerSample, target: Sequence[float]) -> bool:
    """Return whether position and orientation have arrived; q and -q are equal."""
    actual = [math.nan if value is None else value for value in sample.actual]
    same = math.dist(actual[3:], target[3:])
    opposite = math.dist(actual[3:], [-value for value in target[3:]])
    return math.dist(actual[:3], target[:3]) < NEAR and min(same, opposite) < NEAR


def in_the_way(
    wanted: Iterable[str], running: Mapping[str, Iterable[str]]
) -> list[str]:
    """Return the running controllers that command the same joints.

    A Franka accepts torques together with a motion, so a switch does not refuse this;
    but then the torques determine where the joints go. The end effector is the resource
    `<arm>_robot`, which moves all joints `<arm>_joint…`.

    Args:
        wanted: Resources that the motion needs.
        running: Resources of each running controller, by its name.
    """
    needed = set(wanted)
    return [
        name
        for name, resources in running.items()
        if any(_is_same(one, other) for one in resources for other in needed)
    ]


def _is_same(one: str, other: str) -> bool:
    return one == other or _moves(one, other) or _moves(other, one)


def _moves(arm: str, joint: str) -> bool:
    return arm.endswith("_robot") and joint.startswith(
        f"{arm.removesuffix('_robot')}_joint"
    )
