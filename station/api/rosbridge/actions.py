"""The actions of a station: goals, their feedback and their results.

A client sends a goal by the operation `send_action_goal` of ROS 2 or by the topics of
actionlib; the same task follows both.

Source: actionlib_msgs/GoalStatus.msg, action_msgs/msg/GoalStatus.msg;
franka_ros@c11f000 franka_gripper_node.cpp; differs: a gripper's command that did not
reach its aim is aborted; it does not succeed with `success` false.
"""

import asyncio
from collections.abc import Awaitable, Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple, TypeVar, TypeVarTuple

import anyio
import anyio.to_thread

from station.api.rosbridge.broker import Answer
from station.api.rosbridge.ros_types import filled, type_named
from station.api.rosbridge.topics import (
    StationTopics,
    Topic,
    arms_of,
    grippers_of,
    loaded_controllers,
    seconds_of,
)
from station.api.tool_port import ToolClient
from station.core.errors import InvalidCommandError, StationError
from station.core.facade.station import Station
from station.core.franka import GraspRequest
from station.core.franka.gripper_services import DEFAULT_SPEED, Grippers, GripperState
from station.core.ports.goal import Goal, GoalStatus
from station.records.cdr import Values
from station.records.messages import header

FEEDBACK_PERIOD = 0.05
"""Time between two feedbacks of a goal [s]; joint_trajectory_controller has 20 Hz."""
STATUS_PERIOD = 0.2
"""Time between two messages of the topic `status` [s]; actionlib's default is 5 Hz."""
KEPT = 5.0
"""How long an ended goal stays in `status` [s], as in actionlib."""
MOST_THREADS = 16
"""Most threads in which requests of clients wait for the station."""
MOST_GOALS = 32
"""Most goals that are followed at the same time."""
_TRAJECTORY = "control_msgs/FollowJointTrajectory"
_SEQUENCE = "control_msgs/ExecuteMotionPrimitiveSequence"
_GRIPPER = "control_msgs/GripperCommand"
REJECTED = 5
"""actionlib's status number of a refused goal."""
_INVALID_GOAL = -1
"""Error code of a trajectory's goal that fails without a code; 0 means success."""
ACTIONLIB = {
    GoalStatus.PENDING: 0,
    GoalStatus.ACTIVE: 1,
    GoalStatus.PREEMPTED: 2,
    GoalStatus.SUCCEEDED: 3,
    GoalStatus.ABORTED: 4,
}
"""actionlib's status numbers for the states of a goal."""
ROS2 = {GoalStatus.SUCCEEDED: 4, GoalStatus.PREEMPTED: 5, GoalStatus.ABORTED: 6}
"""The status numbers of ROS 2 for the final states of a goal."""
_LEAST_EFFORT = 1e-4


Inputs = TypeVarTuple("Inputs")
Output = TypeVar("Output")


class Progress(NamedTuple):
    """Progress of a goal.

    Attributes:
        status: State of the goal.
        values: The action's feedback, or its result once the goal has ended.
        text: Why it did not succeed.
    """

    status: GoalStatus
    values: Mapping[str, object]
    text: str = ""


class Running(NamedTuple):
    """A goal that has begun. Both functions may block, so call them in worker threads.

    Attributes:
        poll: Returns the progress of the goal.
        cancel: Cancels the goal.
    """

    poll: Callable[[], Progress]
    cancel: Callable[[], object]


@dataclass(frozen=True, slots=True)
class Action:
    """An action.

    Attributes:
        name: Its name.
        type: Its type.
        begin: Begins a goal; may block.
        changes: Whether it changes the station, which needs an operator's rights.
    """

    name: str
    type: str
    begin: Callable[[ToolClient, Values], Running]
    changes: bool = True


@dataclass(slots=True, eq=False)
class TrackedGoal:
    """A goal of a client.

    Attributes:
        action: Its action.
        goal_id: Its `actionlib_msgs/GoalID`.
        code: actionlib's number of its state.
        text: Why it did not succeed.
        running: The goal; None before it begins, and if it was refused.
        ended: When it ended [s, clock of the event loop]; None until then.
        told: Function that is called with each progress of the goal.
    """

    action: Action
    goal_id: Values
    told: Callable[[Answer], None] = lambda _: None
    code: int = 0
    text: str = ""
    running: Running | None = None
    ended: float | None = None
    task: asyncio.Task[None] | None = field(default=None, repr=False)

    def status(self) -> Values:
        """Return the goal as `actionlib_msgs/GoalStatus`."""
        return {"goal_id": self.goal_id, "status": self.code, "text": self.text}


class StationActions:
    """Provides the actions of a station, and follows the goals of clients.

    Args:
        station: The station.
        topics: Topics of the station, whose clock stamps the goals.
        publish: Function that publishes a message, from its topic, type and content.
    """

    def __init__(
        self,
        station: Station,
        topics: StationTopics,
        publish: Callable[[str, str, Values], None],
    ) -> None:
        self._station = station
        self._clock = topics
        self._publish = publish
        self._grippers = Grippers(station.robots)
        self._goals: list[TrackedGoal] = []
        # Separate threads, so that the API's requests never wait for one.
        self._threads = anyio.CapacityLimiter(MOST_THREADS)

    def all(self) -> Iterator[Action]:
        """Yield the present actions."""
        for name, _, controller in loaded_controllers(self._station):
            if controller.goals is None:
                continue
            actions = {"gripper_cmd": _GRIPPER}
            if controller.trajectories is not None:
                actions = {
                    "follow_joint_trajectory": _TRAJECTORY,
                    "motion_sequence": _SEQUENCE,
                }
            for action, kind in actions.items():
                begin = partial(self._begin_goal, name, kind)
                yield Action(f"/{name}/{action}", kind, begin)
        for arm_id, space in grippers_of(self._station):
            for name in ("homing", "stop", "move", "grasp", "gripper_action"):
                own = type_named("franka_msgs", name)
                kind = _GRIPPER if name == "gripper_action" else own
                begin = partial(self._begin_gripper, arm_id, name)
                yield Action(f"{space}/{name}", kind, begin)
        for arm_id, space in arms_of(self._station):
            begin = partial(self._recover, arm_id)
            yield Action(f"{space}/error_recovery", "franka_msgs/ErrorRecovery", begin)

    def topics_of(self, action: Action) -> Iterator[Topic]:
        """Yield the actionlib topics of an action."""
        yield Topic(
            f"{action.name}/status",
            "actionlib_msgs/GoalStatusArray",
            lambda frame: self._status(action, frame.stamp),
            period=STATUS_PERIOD,
            in_pause=True,
        )
        for name in ("feedback", "result"):
            kind = f"{action.type}Action{name.capitalize()}"
            yield Topic(f"{action.name}/{name}", kind)

        def start(client: ToolClient, message: Values) -> Awaitable[None]:
            return self.start(action, client, message["goal"], message["goal_id"])

        def cancel(_: ToolClient, message: Values) -> Awaitable[None]:
            return self.cancel(action, message["id"])

        for name, kind, write in (
            ("goal", f"{action.type}ActionGoal", start),
            ("cancel", "actionlib_msgs/GoalID", cancel),
        ):
            topic = f"{action.name}/{name}"
            yield Topic(topic, kind, write=write, changes=action.changes)

    async def in_thread(
        self, function: Callable[[*Inputs], Output], *inputs: *Inputs
    ) -> Output:
        """Call a function that may block in one of the threads for clients."""
        return await anyio.to_thread.run_sync(function, *inputs, limiter=self._threads)

    async def start(
        self,
        action: Action,
        client: ToolClient,
        goal: Values,
        goal_id: Values,
        told: Callable[[Answer], None] = lambda _: None,
    ) -> None:
        """Begin a goal and follow it to its end.

        Args:
            action: Its action.
            client: The client that sends the goal.
            goal: The goal message.
            goal_id: Its `actionlib_msgs/GoalID`.
            told: Function that is called in the event loop with each progress.

        Raises:
            InvalidCommandError: Too many goals are followed.
            StationError: The goal is refused; the topics report this, too.
        """
        tracked = TrackedGoal(action, goal_id, told)
        self._forget()
        try:
            running = sum(g.ended is None and g.action.changes for g in self._goals)
            if action.changes and running >= MOST_GOALS:
                raise InvalidCommandError(f"There are {MOST_GOALS} goals already.")
            self._goals.append(tracked)
            tracked.running = await self.in_thread(action.begin, client, goal)
        except StationError as error:
            tracked.code, tracked.text = REJECTED, error.message
            tracked.ended = asyncio.get_running_loop().time()
            self._send(tracked, "Result", _failure(error))
            raise
        tracked.task = asyncio.create_task(self._follow(tracked, tracked.running))

    async def cancel(self, action: Action, goal_id: str) -> None:
        """Cancel a goal of an action; without an identifier cancel all its goals."""
        found = [
            one.running
            for one in self._goals
            if one.action.name == action.name
            and one.running is not None
            and one.ended is None
            and goal_id in {"", one.goal_id["id"]}
        ]
        for running in found:
            await self.in_thread(running.cancel)

    async def _follow(self, tracked: TrackedGoal, running: Running) -> None:
        while tracked.ended is None:
            try:
                progress = await self.in_thread(running.poll)
            except StationError as error:
                values = _failure(error)
                progress = Progress(GoalStatus.ABORTED, values, error.message)
            self._report(tracked, progress)
            await asyncio.sleep(FEEDBACK_PERIOD)

    def _report(self, tracked: TrackedGoal, progress: Progress) -> None:
        """Send the feedback or the result of a goal to those who follow it."""
        status, part = progress.status, "Feedback"
        tracked.code, tracked.text = ACTIONLIB[status], progress.text
        if status in ROS2:
            part, tracked.ended = "Result", asyncio.get_running_loop().time()
        elif status is GoalStatus.PENDING or not progress.values:
            return  # the control thread has not yet taken the goal
        values = self._send(tracked, part, progress.values)
        op = f"action_{part.lower()}"
        tracked.told(Answer(op, values, ROS2.get(status, 0), result=True))

    def _send(
        self, tracked: TrackedGoal, part: str, values: Mapping[str, object]
    ) -> Values:
        """Publish a part of a goal, and return it: its `Feedback` or its `Result`."""
        action, now = tracked.action, self._clock.now()
        message = filled(f"{action.type}{part}", values, now)
        head = {"header": header(now), "status": tracked.status()}
        topic, kind = f"{action.name}/{part.lower()}", f"{action.type}Action{part}"
        self._publish(topic, kind, {**head, part.lower(): message})
        return message

    def _status(self, action: Action, stamp: int) -> Values:
        self._forget()
        found = [g.status() for g in self._goals if g.action.name == action.name]
        return {"header": header(stamp), "status_list": found}

    def _forget(self) -> None:
        oldest = asyncio.get_running_loop().time() - KEPT
        self._goals = [g for g in self._goals if g.ended is None or g.ended > oldest]

    def _begin_goal(
        self, name: str, kind: str, client: ToolClient, goal: Values
    ) -> Running:
        control, motion = client.services.control, self._station.motion
        request = goal
        if kind == _TRAJECTORY:
            request = goal | {
                "trajectory": self._clock.trajectory(goal["trajectory"]),
                "goal_time_tolerance": seconds_of(goal["goal_time_tolerance"]),
            }
        admit = partial(control.admit, client.access, client.lease, name)
        given = motion.submit_goal(name, request, admit=admit)
        return Running(
            lambda: _progress(given),
            lambda: motion.cancel_goal(name, given.identifier),
        )

    def _begin_gripper(
        self, arm_id: str, name: str, _: ToolClient, goal: Values
    ) -> Running:
        grippers = self._grippers
        if name == "stop":
            grippers.stop(arm_id)
            return _done({"success": True, "error": ""})
        if name == "homing":
            state = grippers.homing(arm_id)
        elif name == "move":
            state = grippers.move(arm_id, goal["width"], goal["speed"])
        elif name == "grasp":
            within = goal["epsilon"]["inner"], goal["epsilon"]["outer"]
            wanted = GraspRequest(goal["width"], goal["force"], goal["speed"], *within)
            state = grippers.grasp(arm_id, wanted)
        else:
            state = self._begin_gripper_action(arm_id, goal["command"])
        command = state.command or state.last
        number = 0 if command is None else command.identifier
        return Running(
            lambda: _gripper_progress(name, number, grippers.state(arm_id)),
            lambda: grippers.stop(arm_id),
        )

    def _begin_gripper_action(self, arm_id: str, command: Values) -> GripperState:
        """Move or grasp, as franka_gripper's `gripper_action` would do."""
        width, effort = 2.0 * command["position"], abs(command["max_effort"])
        if effort < _LEAST_EFFORT or width >= self._grippers.state(arm_id).width:
            return self._grippers.move(arm_id, width, DEFAULT_SPEED)
        return self._grippers.grasp(arm_id, GraspRequest(width, effort))

    def _recover(self, arm_id: str, _: ToolClient, __: Values) -> Running:
        self._station.robots.recover(arm_id)
        return _done({})


def _failure(error: StationError) -> Values:
    """Return the result of a goal that failed, with the names of all actions."""
    code = error.details.get("error_code", _INVALID_GOAL)
    return {"error_string": error.message, "error": error.message, "error_code": code}


def _progress(goal: Goal) -> Progress:
    """Return the progress of a controller's goal."""
    result = goal.result
    if result is not None:
        facts = {"error_code": result.code, "error_string": result.message}
        return Progress(goal.status, {**result.details, **facts}, result.message)
    # The goal may have ended in between; then the next look finds its result.
    is_pending = goal.status is GoalStatus.PENDING
    status = GoalStatus.PENDING if is_pending else GoalStatus.ACTIVE
    return Progress(status, goal.feedback())


def _done(result: Values) -> Running:
    return Running(lambda: Progress(GoalStatus.SUCCEEDED, result), lambda: None)


def _gripper_progress(name: str, number: int, state: GripperState) -> Progress:
    """Return the progress of a gripper's command."""
    known = (state.command, state.last)
    command = next((c for c in known if c is not None and c.identifier == number), None)
    status = GoalStatus.PREEMPTED if command is None else command.status
    text = "" if command is None else command.message
    is_done = status is GoalStatus.SUCCEEDED
    if name == "gripper_action":
        facts = {"effort": 0.0, "stalled": False, "reached_goal": is_done}
        return Progress(status, {"position": state.width, **facts}, text)
    values = {"success": is_done, "error": text} if status in ROS2 else {}
    return Progress(status, values, text)
