"""Goals and trajectories: read from requests, checked and planned on arrival.

Source: control_msgs@1.5.2 action/FollowJointTrajectory.action, msg/JointTolerance.msg;
differs: times are seconds, `stamp` may stand outside of `header`; tolerances for other
joints are refused, not ignored.
"""

from bisect import bisect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import hypot, isfinite

from typing_extensions import override

from station.controllers.joint_trajectory_controller.execution import ErrorCode
from station.controllers.joint_trajectory_controller.motion_primitives import (
    LINEAR_CARTESIAN,
    LINEAR_JOINT,
    PRIMITIVE_TYPES,
    MotionPrimitive,
    MotionSequences,
)
from station.controllers.joint_trajectory_controller.planning import (
    MAX_DURATION,
    TrajectoryPlanner,
)
from station.core.control.controller import TrajectoryPort
from station.core.errors import ControllerStateError, InvalidTrajectoryError
from station.core.numerics.poses import pose_of
from station.core.ports.command_ticket import CommandTicket
from station.core.ports.goal import Goal, GoalPort
from station.core.trajectory import (
    JointTolerances,
    JointTrajectory,
    JointTrajectoryPoint,
    PosVelAccState,
    ToleranceRequest,
    updated_tolerances,
)

MOST_PRIMITIVES = 200
"""Most primitives of a sequence."""
_LEAST_QUATERNION = 1e-6


@dataclass(frozen=True, slots=True)
class FollowJointTrajectoryGoal:
    """A goal of the action.

    Attributes:
        trajectory: The requested trajectory; without points: stop and hold.
        path_tolerance: Bounds of the errors during the motion, instead of the defaults.
        goal_tolerance: Bounds of the errors at the end, instead of the defaults.
        goal_time_tolerance: Time after the end within which the joints must arrive
            [s]; 0 keeps the default, and a negative value means 0.
    """

    trajectory: JointTrajectory
    path_tolerance: tuple[ToleranceRequest, ...] = ()
    goal_tolerance: tuple[ToleranceRequest, ...] = ()
    goal_time_tolerance: float = 0.0


class FollowJointTrajectoryPort(GoalPort):
    """Checks goals and plans their trajectories; the controller executes them.

    Args:
        planner: Plans the trajectories.
        sequences: Makes trajectories of motion primitives.
        tolerances: Default bounds of the errors by joint.
        is_running: Returns whether the controller is running.
        feedback: Returns the feedback message of the active goal.

    Source:
        ros_controllers@678b92a joint_trajectory_controller_impl.h, goalCB.
    """

    def __init__(
        self,
        planner: TrajectoryPlanner,
        sequences: MotionSequences,
        tolerances: Mapping[str, JointTolerances],
        is_running: Callable[[], bool],
        feedback: Callable[[], Mapping[str, object]],
    ) -> None:
        super().__init__(is_running, feedback)
        self._planner = planner
        self._sequences = sequences
        self._tolerances = tolerances

    @override
    def submit(
        self, request: Mapping[str, object], ticket: CommandTicket | None = None
    ) -> Goal:
        """Check a follow_joint_trajectory goal and let it replace the present one.

        Args:
            request: See `parse_goal`.
            ticket: Notes the cycle that takes the goal.

        Raises:
            ControllerStateError: The controller is not running.
            InvalidTrajectoryError: The goal is malformed or cannot be followed;
                `details["error_code"]` is the error code of the action's result.
        """
        try:
            return self._accept(request, ticket)
        except InvalidTrajectoryError as error:
            error.details["error_code"] = int(error_code_of(error))
            raise

    def _accept(
        self, request: Mapping[str, object], ticket: CommandTicket | None
    ) -> Goal:
        ends: list[float] = []
        wanted = parse_goal(request, lambda message: self._follow(message, ends))
        self._check_tolerances([*wanted.path_tolerance, *wanted.goal_tolerance])
        goal = self.new_goal(request, ticket)
        bounds = updated_tolerances(
            self._tolerances,
            wanted.path_tolerance,
            wanted.goal_tolerance,
            wanted.goal_time_tolerance,
        )
        if ends:
            goal.feedback = lambda: {
                **self._feedback(),
                # The last one goes on until the joints are within the tolerances.
                "current_primitive_index": bisect(
                    ends, goal.progress * ends[-1], hi=len(ends) - 1
                ),
            }
        self._planner.plan(wanted.trajectory, goal, bounds, ticket)
        self.remember(goal)
        return goal

    def _follow(
        self, message: Mapping[str, object], ends: list[float]
    ) -> JointTrajectory:
        """Return the trajectory of a sequence of primitives, and note their ends.

        Raises:
            ControllerStateError: The controller is not running.
            InvalidTrajectoryError: The sequence cannot be followed.
        """
        sequence, frame = parse_sequence(message)
        # What does not run stands nowhere, and who is on the way has no path from here.
        if self._is_running is not None and not self._is_running():
            self.new_goal({})
        points, times = self._sequences.plan(
            sequence, frame, self._planner.resting_place()
        )
        ends += times
        return JointTrajectory(self._sequences.joint_names, points)

    def _check_tolerances(self, tolerances: Sequence[ToleranceRequest]) -> None:
        """Refuse tolerances that would have no effect.

        Raises:
            InvalidTrajectoryError: A tolerance is for a joint that the controller does
                not have, or bounds an acceleration.
        """
        for tolerance in tolerances:
            # No joint tells its acceleration; the original compares an error of 0.
            if tolerance.acceleration > 0.0:
                raise InvalidTrajectoryError(
                    f"The goal has the acceleration tolerance {tolerance.acceleration} "
                    f"for '{tolerance.name}'; joints have no measured acceleration, so "
                    "it would never be checked.",
                    remedy="Leave it out, or give a velocity tolerance.",
                    details={"joint": tolerance.name, "quantity": "acceleration"},
                )
            if tolerance.name not in self._tolerances:
                known = ", ".join(self._tolerances)
                raise InvalidTrajectoryError(
                    f"The goal has a tolerance for '{tolerance.name}'; the joints are "
                    f"{known}.",
                    remedy="Name tolerances after joints of the controller.",
                    details={"joint": tolerance.name},
                )

    @override
    def void(self, reason: str) -> None:
        """End every goal and every trajectory without a goal; the joints hold."""
        super().void(reason)
        self._planner.execution.hold(is_void=True)


class JointTrajectoryPort(TrajectoryPort):
    """The topic `command` and the service `query_state` of the original.

    Args:
        planner: Plans the trajectories.
        is_running: Returns whether the controller is running.
    """

    def __init__(
        self, planner: TrajectoryPlanner, is_running: Callable[[], bool]
    ) -> None:
        self._planner = planner
        self._is_running = is_running

    @override
    def follow_trajectory(
        self, request: Mapping[str, object], ticket: CommandTicket | None = None
    ) -> None:
        """Replace the trajectory being executed.

        Args:
            request: See `parse_trajectory`; without points: stop and hold.
            ticket: Notes the cycle that takes the trajectory.

        Raises:
            ControllerStateError: The controller is not running.
            InvalidTrajectoryError: The trajectory is malformed or cannot be followed.
        """
        trajectory = parse_trajectory(request)
        self._check_running()
        self._planner.plan(trajectory, ticket=ticket)

    @override
    def hold(self, ticket: CommandTicket | None = None) -> None:
        self._planner.execution.hold(ticket)

    @override
    def query_state(self, time: float) -> PosVelAccState:
        """Return the desired state of the joints at a station time [s].

        Raises:
            ControllerStateError: The controller is not running.
            InvalidTrajectoryError: `time` is before the executed trajectory.
        """
        self._check_running()
        return self._planner.query(time)

    def _check_running(self) -> None:
        if not self._is_running():
            raise ControllerStateError(
                "The controller is not running; it has no trajectory.",
                remedy="Start the controller first.",
            )


def parse_goal(
    request: Mapping[str, object],
    follow: Callable[[Mapping[str, object]], JointTrajectory] | None = None,
) -> FollowJointTrajectoryGoal:
    """Read a goal from JSON-compatible values shaped like the action's message.

    Args:
        follow: Makes a trajectory of a `trajectory` that has `motions`.
        request: `{"trajectory": {"joint_names", "points": [{"positions", "velocities",
            "accelerations", "time_from_start"}], "stamp"}, "path_tolerance":
            [{"name", "position", "velocity", "acceleration"}], "goal_tolerance",
            "goal_time_tolerance"}`; only `trajectory` is required.

    Raises:
        InvalidTrajectoryError: A field is missing, unknown or has the wrong type.
    """
    known = {
        "trajectory",
        "path_tolerance",
        "goal_tolerance",
        "goal_time_tolerance",
    }
    _refuse_unknown(request, known, "the goal")
    trajectory = _mapping(request.get("trajectory"), "trajectory")
    has_motions = "motions" in trajectory
    read = follow if follow is not None and has_motions else parse_trajectory
    return FollowJointTrajectoryGoal(
        read(trajectory),
        _tolerances(request, "path_tolerance"),
        _tolerances(request, "goal_tolerance"),
        _goal_time(request),
    )


def error_code_of(error: InvalidTrajectoryError) -> ErrorCode:
    """Return the error code with which the original refuses a goal.

    Source:
        ros_controllers@678b92a joint_trajectory_controller_impl.h, goalCB: a
        goal with wrong joints has INVALID_JOINTS, all others have INVALID_GOAL.
    """
    if error.details.get("reason") == "joints":
        return ErrorCode.INVALID_JOINTS
    return ErrorCode.INVALID_GOAL


def parse_trajectory(message: Mapping[str, object]) -> JointTrajectory:
    """Read a trajectory from values shaped like trajectory_msgs/JointTrajectory.

    Args:
        message: `{"joint_names", "points", "stamp"}`; the points are those of a goal.
            An empty message has no joints and no points.

    Raises:
        InvalidTrajectoryError: A field is missing, unknown or has the wrong type.
    """
    known = {"header", "joint_names", "points", "stamp"}
    _refuse_unknown(message, known, "trajectory")
    header = _mapping(message.get("header", {}), "trajectory/header")
    points = _list(message.get("points", []), "trajectory/points")
    stamp = _number(message, "stamp", "trajectory/stamp")
    return JointTrajectory(
        _joint_names(message.get("joint_names", [])),
        [
            _point(_mapping(point, f"trajectory/points/{index}"), index)
            for index, point in enumerate(points)
        ],
        stamp or _number(header, "stamp", "trajectory/header/stamp"),
    )


def parse_sequence(message: Mapping[str, object]) -> tuple[list[MotionPrimitive], str]:
    """Read values shaped like control_msgs/MotionPrimitiveSequence.

    Args:
        message: `{"motions": [{"type", "blend_radius", "additional_arguments":
            [{"name", "value"}], "poses": [{"header": {"frame_id"}, "pose": {"position",
            "orientation"}}], "joint_positions"}]}`; types are numbers or names, vectors
            mappings or lists.

    Returns:
        The primitives, and the frame of all poses; "" when none is named.

    Raises:
        InvalidTrajectoryError: A field is missing, unknown or has the wrong type, or a
            primitive has not the target that its type needs.
    """
    _refuse_unknown(message, {"motions"}, "trajectory")
    return _sequence(_list(message.get("motions"), "trajectory/motions"))


def _sequence(motions: list[object]) -> tuple[list[MotionPrimitive], str]:
    if not 1 <= len(motions) <= MOST_PRIMITIVES:
        wanted = f"1 to {MOST_PRIMITIVES} primitives"
        raise _wrong("trajectory/motions", f"{len(motions)} primitives", wanted)
    frames: set[str] = set()
    found = [_primitive(index, one, frames) for index, one in enumerate(motions)]
    if len(frames) > 1:
        raise _wrong("trajectory/motions", sorted(frames), "poses in one frame")
    if found[-1].blend_radius > 0.0:
        where = f"trajectory/motions/{len(found) - 1}/blend_radius"
        raise _wrong(where, found[-1].blend_radius, "0: nothing follows")
    return found, max(frames, default="")


def _primitive(index: int, value: object, frames: set[str]) -> MotionPrimitive:
    where = f"trajectory/motions/{index}"
    message = _mapping(value, where)
    known = {"type", "blend_radius", "additional_arguments", "poses", "joint_positions"}
    _refuse_unknown(message, known, where)
    given = message.get("type")
    kind = PRIMITIVE_TYPES.get(given) if isinstance(given, int | str) else None
    if kind is None:
        raise _wrong(f"{where}/type", given, "0 (PTP), 50 (LIN) or 51 (CIRC)")
    arguments = {}
    for entry in _list(message.get("additional_arguments", []), where):
        argument = _mapping(entry, f"{where}/additional_arguments")
        name = argument.get("name")
        if name not in {"velocity", "acceleration", "move_time"}:
            raise _wrong(f"{where}/additional_arguments/name", name, "an argument")
        arguments[str(name)] = _not_negative(argument, "value", f"{where}/{name}")
    poses = [
        _pose(_mapping(one, f"{where}/poses"), f"{where}/poses", frames)
        for one in _list(message.get("poses", []), f"{where}/poses")
    ]
    joints = _numbers(message, "joint_positions", where)
    least = {LINEAR_JOINT: 0, LINEAR_CARTESIAN: 1}.get(kind, 2)
    if len(poses) != least or bool(joints) != (least == 0):
        wanted = f"{least} poses" if least else "joint_positions, and no poses"
        raise _wrong(where, f"with {len(poses)} poses", f"one with {wanted}")
    radius = _not_negative(message, "blend_radius", f"{where}/blend_radius")
    # An argument of 0 has not been given, as in the original.
    given_ones = {name: number for name, number in arguments.items() if number}
    return MotionPrimitive(kind, radius, given_ones, poses, joints)


def _pose(message: Mapping[str, object], where: str, frames: set[str]) -> list[float]:
    _refuse_unknown(message, {"header", "pose"}, where)
    header = _mapping(message.get("header", {}), f"{where}/header")
    frame = header.get("frame_id", "")
    if frame:
        frames.add(str(frame))
    pose = _mapping(message.get("pose"), f"{where}/pose")
    vectors = []
    for name, keys in (("position", "xyz"), ("orientation", "xyzw")):
        found = pose.get(name)
        if isinstance(found, Mapping):
            found = [found.get(key) for key in keys]
        vector = [
            _as_number(one, f"{where}/{name}")
            for one in _list(found, f"{where}/{name}")
        ]
        if len(vector) != len(keys) or not all(map(isfinite, vector)):
            raise _wrong(f"{where}/{name}", vector, ", ".join(keys))
        vectors.append(vector)
    if hypot(*vectors[1]) < _LEAST_QUATERNION:
        raise _wrong(f"{where}/orientation", vectors[1], "a quaternion, not 0")
    return pose_of(*vectors)


def _not_negative(message: Mapping[str, object], key: str, where: str) -> float:
    number = _finite(message, key, where)
    if number < 0.0:
        raise _wrong(where, number, "0 or more")
    return number


def _joint_names(value: object) -> list[str]:
    names = value if isinstance(value, (list, tuple)) else [None]
    if not all(isinstance(name, str) for name in names):
        raise _wrong("trajectory/joint_names", value, "a list of joint names")
    return [str(name) for name in names]


def _point(message: Mapping[str, object], index: int) -> JointTrajectoryPoint:
    where = f"trajectory/points/{index}"
    known = {"positions", "velocities", "accelerations", "effort", "time_from_start"}
    _refuse_unknown(message, known, where)
    return JointTrajectoryPoint(
        _numbers(message, "positions", where),
        _numbers(message, "velocities", where),
        _numbers(message, "accelerations", where),
        _number(message, "time_from_start", f"{where}/time_from_start"),
    )


def _goal_time(request: Mapping[str, object]) -> float:
    seconds = _finite(request, "goal_time_tolerance", "goal_time_tolerance")
    if seconds > MAX_DURATION:
        raise _wrong(
            "goal_time_tolerance", seconds, f"at most {MAX_DURATION:g} s, or negative"
        )
    return seconds


def _tolerances(
    request: Mapping[str, object], key: str
) -> tuple[ToleranceRequest, ...]:
    tolerances = []
    for index, entry in enumerate(_list(request.get(key, []), key)):
        where = f"{key}/{index}"
        message = _mapping(entry, where)
        _refuse_unknown(
            message, {"name", "position", "velocity", "acceleration"}, where
        )
        name = message.get("name")
        if not isinstance(name, str):
            raise _wrong(f"{where}/name", name, "the name of a joint")
        tolerances.append(
            ToleranceRequest(
                name,
                _finite(message, "position", f"{where}/position"),
                _finite(message, "velocity", f"{where}/velocity"),
                _finite(message, "acceleration", f"{where}/acceleration"),
            )
        )
    return tuple(tolerances)


def _refuse_unknown(message: Mapping[str, object], known: set[str], where: str) -> None:
    unknown = [key for key in message if key not in known]
    if unknown:
        raise _wrong(where, unknown, f"made of {', '.join(sorted(known))} only")


def _mapping(value: object, where: str) -> Mapping[str, object]:
    if not isinstance(value, Mapping):
        raise _wrong(where, value, "a mapping")
    return value


def _list(value: object, where: str) -> list[object]:
    if not isinstance(value, (list, tuple)):
        raise _wrong(where, value, "a list")
    return list(value)


def _numbers(message: Mapping[str, object], key: str, where: str) -> list[float]:
    values = _list(message.get(key, []), f"{where}/{key}")
    return [_as_number(value, f"{where}/{key}") for value in values]


def _number(message: Mapping[str, object], key: str, where: str) -> float:
    return _as_number(message.get(key, 0.0), where)


def _finite(message: Mapping[str, object], key: str, where: str) -> float:
    number = _number(message, key, where)
    if not isfinite(number):
        raise _wrong(where, number, "a finite number")
    return number


def _as_number(value: object, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise _wrong(where, value, "a number")
    return float(value)


def _wrong(where: str, value: object, wanted: str) -> InvalidTrajectoryError:
    is_sequence = where.startswith("trajectory/motions")
    shape = "MotionPrimitiveSequence" if is_sequence else "FollowJointTrajectoryGoal"
    return InvalidTrajectoryError(
        f"'{where}' is {value!r}; it must be {wanted}.",
        remedy=f"Send a goal shaped like control_msgs/{shape}.",
        details={"field": where},
    )
