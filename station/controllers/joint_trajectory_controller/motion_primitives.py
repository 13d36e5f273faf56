"""Sequences of motion primitives, PTP, LIN and CIRC, as trajectories of the joints.

At first a primitive is a path without times: PTP is straight in joint space; LIN and
CIRC lead the tip along a line or an arc; inverse kinematics gives the joints. Within
the blend radius of its end a primitive passes into the next one. Then every piece gets
its times: the speed changes by ramps of bounded jerk and is constant in a blend.

Source: control_msgs@5.x msg/MotionPrimitive.msg; ros2_controllers@4.x
motion_primitives_controllers; moveit2 pilz_industrial_motion_planner,
trajectory_blender_transition_window.cpp, for the weight of a blend; differs: the blend
is one of paths, which keeps its speed.
"""

import threading
from bisect import bisect_left
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, hypot, inf, pi, sqrt
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from station.core.description.robot_description import JointDescription
from station.core.errors import InvalidTrajectoryError, StationError
from station.core.numerics.arm_chain import JointChain, least_rates
from station.core.numerics.poses import displace, twist_between
from station.core.ports.set_point import RANGE_TOLERANCE
from station.core.trajectory import (
    JointTrajectoryPoint,
    PosVelAccState,
    QuinticSplineSegment,
)
from station.core.trajectory.speed_law import SpeedBounds, SpeedLaw
from station.memory.doubles import doubles, zeros

LINEAR_JOINT, LINEAR_CARTESIAN, CIRCULAR_CARTESIAN = 0, 50, 51
"""Types of primitives: PTP, LIN and CIRC."""
PRIMITIVE_TYPES: Mapping[int | str, int] = {
    **dict.fromkeys((LINEAR_JOINT, "LINEAR_JOINT", "PTP"), LINEAR_JOINT),
    **dict.fromkeys((LINEAR_CARTESIAN, "LINEAR_CARTESIAN", "LIN"), LINEAR_CARTESIAN),
    **dict.fromkeys(
        (CIRCULAR_CARTESIAN, "CIRCULAR_CARTESIAN", "CIRC"), CIRCULAR_CARTESIAN
    ),
}
"""Numbers and names of the types."""
# Of the leading joint [rad/s, rad/s^2], and of the tip [m/s, m/s^2].
# Source: ur_client_library instruction_executor.h, moveJ and moveL.
_JOINT_DEFAULTS, _TIP_DEFAULTS = (1.04, 1.4), (0.25, 1.2)
_TIME_TO_SPEED = 0.5
"""Bound of accelerations: full velocity is reached after about this time [s]."""
_TIME_TO_ACCELERATION = 0.1
"""Bound of the jerk: full acceleration is reached after this time [s]."""
_SHARE = 0.98
"""Part of a joint's limits that is used: between two points it may be a bit faster."""
_SLOWEST = 0.02
"""Part of the wanted speed below which a path is refused for its singular pose."""
_SAMPLE, _TURN_SAMPLE = 2e-3, 0.01
"""Distance between the poses of a path for which joints are computed [m], [rad]."""
_BLEND_SAMPLES = 80
_EXACT = 1e-11
"""Largest error of the tip [m, rad]; small, because joints are differenced twice."""
_JUMP = 0.3
"""Step of a joint between two poses of a path from which on the path is refused
[rad]."""
_POINT_PERIOD = 0.02
"""Time between two points of the trajectory [s]."""
_SAME_PLACE = 1e-6
"""Distance below which the tip only turns [m]."""
_NOTHING = 1e-9
"""Length of a path that leads nowhere [m or rad]."""

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class MotionPrimitive:
    """One motion of a sequence.

    Attributes:
        type: `LINEAR_JOINT`, `LINEAR_CARTESIAN` or `CIRCULAR_CARTESIAN`.
        blend_radius: Distance of the tip from the end within which the motion passes
            into the next one [m], 0 to stop at the end.
        arguments: `velocity` and `acceleration`, which are not exceeded, of the joint
            that moves most [rad/s, rad/s^2] or of the tip [m/s, m/s^2]; `move_time`,
            from rest to rest [s].
        poses: The goal, and the via pose of a circle: 16 numbers each.
        joint_positions: The goal of `LINEAR_JOINT` [rad or m].
    """

    type: int
    blend_radius: float
    arguments: Mapping[str, float]
    poses: Sequence[list[float]]
    joint_positions: Sequence[float]


def _refuse(index: int, reason: str, problem: str, **facts: object) -> NoReturn:
    raise InvalidTrajectoryError(
        f"Primitive {index}: {problem}.",
        remedy="Change this primitive of the sequence.",
        details={"primitive": index, "reason": reason, **facts},
    )


@dataclass(slots=True)
class _Path:
    """A path without times: one primitive without blends.

    Attributes:
        index: Index of the primitive.
        length: Length of the path [m]; [rad] for a motion of joints or a rotation.
        scale: Length of the path per unit of the motion that `velocity` limits.
        spacing: Length between two samples.
        q: Returns the positions of joints at a length; None for a path of the tip.
        pose: Returns the pose of the tip at a length.
    """

    index: int
    length: float
    scale: float
    spacing: float
    q: Callable[[float], Array] | None
    pose: Callable[[float], list[float]]


@dataclass(slots=True)
class _Piece:
    """A part of the whole path, by its own length.

    Attributes:
        path: The path; the first one of a blend.
        at: Lengths of the samples, shape (k,).
        q, slope, bend: Positions of joints and their derivatives by the length, shape
            (k, n).
        is_blend: Whether it is a blend.
        entry, leave: Speed in a blend per speed of the primitive before it and after
            it.
    """

    path: _Path
    at: Array
    q: Array
    slope: Array
    bend: Array
    is_blend: bool = False
    entry: float = 1.0
    leave: float = 1.0

    @property
    def length(self) -> float:
        """Return its length [m or rad]."""
        return float(self.at[-1])


class MotionSequences:
    """Turns sequences of primitives into trajectories.

    Args:
        joints: The joints, n of them.
        chain_in: Returns the chain from a frame to the tip; "" for the arm's base.

    Attributes:
        joint_names: Names of the joints.
    """

    def __init__(
        self,
        joints: Sequence[JointDescription],
        chain_in: Callable[[str], JointChain],
    ) -> None:
        self.joint_names = [joint.name for joint in joints]
        self._joints = joints
        self._chain_in = chain_in
        # A chain is memory for one thread.
        self._planning = threading.Lock()
        velocity = np.array([_SHARE * joint.velocity for joint in joints])
        self._velocity, self._acceleration = velocity, velocity / _TIME_TO_SPEED

    def plan(
        self, sequence: Sequence[MotionPrimitive], frame: str, start: Sequence[float]
    ) -> tuple[list[JointTrajectoryPoint], list[float]]:
        """Return the trajectory of a sequence, from rest to rest.

        Args:
            sequence: One primitive or more, the last one without a blend radius.
            frame: Link in whose frame the poses are; "" for the base of the arm.
            start: Positions in which the joints are held [rad or m], shape (n,).

        Returns:
            The points; and when each primitive ends, or is in the middle of its blend
            [s].

        Raises:
            InvalidTrajectoryError: A primitive cannot be followed;
                `details["primitive"]` is its index, `details["reason"]` why.
        """
        with self._planning:
            try:
                self._chain = self._chain_in(frame)
            except StationError as error:
                raise InvalidTrajectoryError(
                    error.message, remedy=error.remedy
                ) from error
            pieces, blends = self._pieces(sequence, np.array(start))
        points: list[JointTrajectoryPoint] = []
        ends, now = [0.0 for _ in sequence], 0.0
        for piece, law in self._timed(sequence, pieces, blends):
            duration = law.duration
            points += _points(piece, law, now) if duration > 0.0 else []
            # The blend comes after the inner part, and is what counts.
            ends[piece.path.index] = now + (0.5 if piece.is_blend else 1.0) * duration
            now += duration
        rest = [0.0] * len(start)
        return points or [JointTrajectoryPoint(start, rest, rest, _POINT_PERIOD)], ends

    def _pieces(
        self, sequence: Sequence[MotionPrimitive], q: Array
    ) -> tuple[list[_Piece], list[_Piece | None]]:
        """Return the inner parts of the primitives, and the blends at their ends."""
        inner: list[_Piece] = []
        blends: list[_Piece | None] = []
        path, begin = self._path(0, sequence[0], q), 0.0
        for index, primitive in enumerate(sequence):
            cut = self._cut(path, primitive.blend_radius, is_end=True)
            if cut < begin:
                problem = "its blend radius and that of the primitive before it overlap"
                _refuse(index, "blend", problem)
            inner.append(self._piece(path, begin, cut, q))
            q, begin = inner[-1].q[-1], 0.0
            if index + 1 == len(sequence):
                blends.append(None)
                break
            grid = np.linspace(cut, path.length, _BLEND_SAMPLES)
            tail = self._rows(path, grid, q)
            following = self._path(index + 1, sequence[index + 1], tail[-1])
            blend, q = None, tail[-1]
            if primitive.blend_radius > 0.0:
                begin = self._cut(following, primitive.blend_radius, is_end=False)
                blend = self._blend(path, cut, tail, following, begin)
                q = blend.q[-1]
            blends.append(blend)
            path = following
        return inner, blends

    def _path(self, index: int, primitive: MotionPrimitive, q: Array) -> _Path:
        if primitive.type == LINEAR_JOINT:
            if len(primitive.joint_positions) != len(q):
                given = len(primitive.joint_positions)
                problem = f"it has {given} joint_positions for {len(q)} joints"
                _refuse(index, "target", problem)
            way = np.array(primitive.joint_positions) - q
            length = float(np.linalg.norm(way))
            unit = way / max(length, _NOTHING)
            scale = length / max(float(np.abs(way).max()), _NOTHING)

            def place(s: float) -> Array:
                return q + s * unit

            return _Path(
                index,
                length,
                scale,
                _TURN_SAMPLE,
                place,
                lambda s: self._tip(place(s)),
            )
        here = self._tip(q)
        if primitive.type == CIRCULAR_CARTESIAN:
            length, pose = _arc(index, here, *primitive.poses)
            return _Path(index, length, 1.0, _SAMPLE, None, pose)
        shift = twist_between(here, primitive.poses[0], 1.0)
        length, spacing = hypot(*shift[:3]), _SAMPLE
        if length < _SAME_PLACE:
            length, spacing = hypot(*shift[3:]), _TURN_SAMPLE
        share = 1.0 / max(length, _NOTHING)
        return _Path(
            index,
            length,
            1.0,
            spacing,
            None,
            lambda s: displace(
                here,
                [s * share * v for v in shift[:3]],
                [s * share * v for v in shift[3:]],
            ),
        )

    def _tip(self, q: Array) -> list[float]:
        self._chain.place(doubles(q))
        return [*self._chain.pose]

    def _cut(self, path: _Path, radius: float, *, is_end: bool) -> float:
        """Return the length at which the tip is at a distance from an end of a path."""
        end = path.length if is_end else 0.0
        if radius == 0.0:
            return end
        corner = path.pose(end)[12:15]

        def is_beyond(s: float) -> bool:
            return hypot(*np.subtract(path.pose(s)[12:15], corner)) >= radius

        near, far = end, end
        for k in range(65):
            far = abs(end - k / 64 * path.length)
            if is_beyond(far):
                break
            near = far
        else:
            problem = f"a blend radius of {radius:g} m reaches beyond its other end"
            _refuse(path.index, "blend", problem)
        for _ in range(60):
            middle = 0.5 * (near + far)
            near, far = (near, middle) if is_beyond(middle) else (middle, far)
        return far

    def _piece(self, path: _Path, begin: float, end: float, q: Array) -> _Piece:
        count = min(max(ceil((end - begin) / path.spacing), 8), 4000) + 1
        rows = self._rows(path, np.linspace(begin, end, count), q)
        at = np.linspace(0.0, end - begin, count)
        return _Piece(path, at, rows, *_derivatives(rows, np.gradient(at)))

    def _blend(
        self, path: _Path, cut: float, tail: Array, following: _Path, until: float
    ) -> _Piece:
        """Pass from one path into the next one, from `cut` to `until`.

        Both are weighted by a polynomial whose first two derivatives are 0 at its ends,
        so that speed and curvature go on. A sphere contains all points between two of
        its points: so the tip leaves the paths only within the blend radius.
        """
        u = np.linspace(0.0, 1.0, len(tail))
        weights = u**3 * (10.0 - 15.0 * u + 6.0 * u * u)
        head = np.linspace(0.0, until, len(tail))
        is_of_tip = path.q is None and following.q is None
        if is_of_tip:
            poses = []
            for one, other, w in zip(
                np.linspace(cut, path.length, len(tail)), head, weights, strict=True
            ):
                first = path.pose(one)
                way = twist_between(first, following.pose(other), 1.0)
                poses.append(
                    displace(first, [w * v for v in way[:3]], [w * v for v in way[3:]])
                )
            rows = self._follow(path.index, poses, tail[0])
            metric = np.array(poses)[:, 12:15]
        else:
            heads = self._rows(following, head, tail[-1])
            rows = metric = tail + weights[:, None] * (heads - tail)
        speed = np.linalg.norm(np.gradient(metric, u, axis=0, edge_order=2), axis=1)
        steps = np.diff(u) * 0.5 * (speed[1:] + speed[:-1])
        at = np.concatenate([[0.0], np.cumsum(steps)])
        piece = _Piece(path, at, rows, *_derivatives(rows, speed * u[1]))
        # Its ends are as fast as the paths: the length of one is that of the other.
        piece.is_blend = True
        piece.entry = float(speed[0]) / max(path.length - cut, _NOTHING)
        piece.leave = float(speed[-1]) / max(until, _NOTHING)
        return piece

    def _rows(self, path: _Path, at: Array, q: Array) -> Array:
        """Return the positions of joints along a path, shape (k, n).

        Args:
            path: The path.
            at: Lengths, shape (k,).
            q: Positions at the first one, shape (n,).
        """
        if path.q is None:
            return self._follow(path.index, [path.pose(s) for s in at.tolist()], q)
        return self._within_limits(path.index, np.array([path.q(s) for s in at]))

    def _follow(self, index: int, poses: Sequence[list[float]], q: Array) -> Array:
        """Return positions of joints that lead the tip through poses, shape (k, n)."""
        chain, now = self._chain, doubles(q)
        error, step, matrix = zeros(6), zeros(len(q)), zeros(36)
        rows = []
        for number, pose in enumerate(poses):
            target, before = doubles(pose), [*now]
            for _ in range(12):
                chain.place(now)
                error[:] = doubles(twist_between(chain.pose, target, 1.0))
                if max(map(abs, error)) < _EXACT:
                    break
                chain.differentiate()
                least_rates(chain.jacobian, error, matrix, 1e-12, step)
                for k, change in enumerate(step):
                    now[k] += change
            else:
                share = number / len(poses)
                _refuse(
                    index,
                    "unreachable",
                    f"the tip cannot follow it beyond {100.0 * share:.0f} % of its way",
                    share=share,
                )
            if number and max(map(abs, np.subtract(now, before))) > _JUMP:
                self._refuse_singular(index, number / len(poses))
            rows.append([*now])
        return self._within_limits(index, np.array(rows))

    def _within_limits(self, index: int, rows: Array) -> Array:
        for k, joint in enumerate(self._joints):
            # A joint that is beyond a limit may come back.
            lower = min(joint.lower - RANGE_TOLERANCE, rows[0, k])
            upper = max(joint.upper + RANGE_TOLERANCE, rows[0, k])
            beyond = np.flatnonzero((rows[:, k] < lower) | (rows[:, k] > upper))
            if len(beyond):
                _refuse(
                    index,
                    "limits",
                    f"it would lead '{joint.name}' to {rows[beyond[0], k]:.4g}; "
                    f"allowed is {joint.lower:.4g} to {joint.upper:.4g}",
                    joint=joint.name,
                )
        return rows

    def _refuse_singular(self, index: int, share: float) -> NoReturn:
        _refuse(
            index,
            "singular",
            f"after {100.0 * share:.0f} % of its way it passes too near to a singular "
            "pose, where the joints would have to be too fast",
            share=share,
        )

    def _timed(
        self,
        sequence: Sequence[MotionPrimitive],
        inner: Sequence[_Piece],
        blends: Sequence[_Piece | None],
    ) -> list[tuple[_Piece, SpeedLaw]]:
        """Return all pieces in their order with their speeds."""
        bounds = [
            self._bounds(primitive, piece)
            for primitive, piece in zip(sequence, inner, strict=True)
        ]
        # Speeds in the blends: within the limits, and such that the ramps between them
        # fit, forwards and backwards.
        speeds = [0.0] * len(blends)
        for k, blend in enumerate(blends):
            if blend is not None:
                speeds[k] = min(
                    float(self._fastest(blend)),
                    bounds[k].speed * blend.entry,
                    bounds[k + 1].speed * blend.leave,
                )
        for k, blend in enumerate(blends):
            if blend is not None:
                before = _speed_after(blends, speeds, k)
                reached = bounds[k].reached_from(before, inner[k].length)
                speeds[k] = min(speeds[k], reached * blend.entry)
        for k in reversed(range(len(blends) - 1)):
            blend = blends[k]
            if blend is not None:
                behind = _speed_before(blends, speeds, k + 1)
                reached = bounds[k + 1].reached_from(behind, inner[k + 1].length)
                speeds[k] = min(speeds[k], reached * blend.leave)
        found = []
        for k, (piece, blend) in enumerate(zip(inner, blends, strict=True)):
            begin = _speed_after(blends, speeds, k)
            end = _speed_before(blends, speeds, k)
            if piece.length < _NOTHING:
                found.append((piece, SpeedLaw(0.0, [])))
            else:
                found.append((
                    piece,
                    SpeedLaw.between(begin, end, piece.length, bounds[k]),
                ))
            if blend is not None:
                phases = [(blend.length / speeds[k], 0.0)]
                found.append((blend, SpeedLaw(speeds[k], phases)))
        return found

    def _fastest(self, piece: _Piece) -> Array:
        """Return the largest speed that joint velocities and accelerations allow."""
        with np.errstate(divide="ignore", invalid="ignore"):
            by_speed = self._velocity / np.abs(piece.slope)
            by_bend = np.sqrt(0.5 * self._acceleration / np.abs(piece.bend))
        found = np.nanmin(np.minimum(by_speed, by_bend), initial=inf)
        return np.array(found)

    def _bounds(self, primitive: MotionPrimitive, piece: _Piece) -> SpeedBounds:
        """Return the bounds of the speed along a primitive."""
        path, arguments = piece.path, primitive.arguments
        index, scale = path.index, path.scale
        usual = _TIP_DEFAULTS if path.spacing == _SAMPLE else _JOINT_DEFAULTS
        wanted = scale * arguments.get("velocity", usual[0])
        push = scale * arguments.get("acceleration", usual[1])
        time = arguments.get("move_time", 0.0)
        rise = _TIME_TO_ACCELERATION
        if time:
            # A quarter of the time is spent in each ramp, and half of it at speed.
            ramp = 0.25 * time
            wanted = path.length / (time - ramp)
            push, rise = wanted / (0.75 * ramp), 0.25 * ramp
        speed = min(wanted, float(self._fastest(piece)))
        with np.errstate(divide="ignore", invalid="ignore"):
            left = self._acceleration - np.abs(piece.bend) * speed * speed
            room = np.nanmin(left / np.abs(piece.slope), initial=inf)
        if time and (speed < wanted or room < push):
            factor = max(wanted / speed, sqrt(max(push / float(room), 1.0)))
            _refuse(
                index,
                "pace",
                f"the joints cannot follow it in {time:g} s; it takes "
                f"{1.01 * factor * time:.3g} s or more",
                duration=1.01 * factor * time,
            )
        if speed < _SLOWEST * min(wanted, scale * usual[0]):
            worst = int(np.argmax(np.abs(piece.slope).max(axis=1)))
            self._refuse_singular(index, worst / len(piece.at))
        push = min(push, float(room))
        return SpeedBounds(speed, push, push / rise)


def _speed_after(
    blends: Sequence[_Piece | None], speeds: Sequence[float], index: int
) -> float:
    """Return the speed with which a primitive begins, behind the blend before it."""
    blend = blends[index - 1] if index else None
    return 0.0 if blend is None else speeds[index - 1] / blend.leave


def _speed_before(
    blends: Sequence[_Piece | None], speeds: Sequence[float], index: int
) -> float:
    """Return the speed with which a primitive ends, before its blend."""
    blend = blends[index]
    return 0.0 if blend is None else speeds[index] / blend.entry


def _arc(
    index: int, here: list[float], goal: list[float], via: list[float]
) -> tuple[float, Callable[[float], list[float]]]:
    """Return the arc from a pose through a point to a goal: its length, and its poses.

    The rotation is that from the start to the goal; the via pose has no part in it.

    Raises:
        InvalidTrajectoryError: The three points lie on no circle.
    """
    start, end = np.array(here[12:15]), np.array(goal[12:15])
    one, other = np.array(via[12:15]) - start, end - start
    normal = np.cross(one, other)
    square = float(normal @ normal)
    if square <= (1e-6 * float(one @ one + other @ other)) ** 2:
        _refuse(index, "circle", "its start, via point and goal lie on no circle")
    # The centre of the circle through 0, a and b.
    to_centre = np.cross(normal, (one @ one) * other - (other @ other) * one) / (
        -2.0 * square
    )
    radius = float(np.linalg.norm(to_centre))
    centre, x = start + to_centre, -to_centre / radius
    y = np.cross(normal / sqrt(square), x)
    away = end - centre
    angle = float(np.arctan2(away @ y, away @ x)) % (2.0 * pi)
    turn = twist_between(here, goal, 1.0)[3:]

    def pose(s: float) -> list[float]:
        phi = s / radius
        place = centre + radius * (np.cos(phi) * x + np.sin(phi) * y)
        return displace(
            here, (place - start).tolist(), [phi / angle * part for part in turn]
        )

    return radius * angle, pose


def _derivatives(rows: Array, speed: Array) -> tuple[Array, Array]:
    """Return the first two derivatives of rows by a length, shape (k, n) each.

    Args:
        rows: Values, shape (k, n).
        speed: Length per row, shape (k,).
    """
    first = np.gradient(rows, axis=0, edge_order=2)
    second = np.empty_like(rows)
    second[1:-1] = rows[2:] - 2.0 * rows[1:-1] + rows[:-2]
    second[0], second[-1] = 2 * second[1] - second[2], 2 * second[-2] - second[-3]
    along = np.maximum(speed, 1e-15)[:, None]
    slope = first / along
    change = np.gradient(along, axis=0, edge_order=2)
    return slope, (second - slope * change) / along**2


def _points(piece: _Piece, law: SpeedLaw, begin: float) -> list[JointTrajectoryPoint]:
    """Return the points of a piece after its first one."""
    count = max(ceil(law.duration / _POINT_PERIOD), 1)
    rows = zip(piece.q.tolist(), piece.slope.tolist(), piece.bend.tolist(), strict=True)
    states, at = [PosVelAccState(*row) for row in rows], piece.at.tolist()
    points = []
    for k in range(1, count + 1):
        time = law.duration * k / count
        s, v, a = law.at(time)
        s = min(s, piece.length) if k < count else piece.length
        end = min(max(bisect_left(at, s), 1), len(at) - 1)
        segment = QuinticSplineSegment(
            at[end - 1], states[end - 1], at[end], states[end]
        )
        here = segment.sample(s)
        slope, bend = here.velocity, here.acceleration
        points.append(
            JointTrajectoryPoint(
                here.position,
                [one * v for one in slope],
                [two * v * v + one * a for one, two in zip(slope, bend, strict=True)],
                begin + time,
            )
        )
    return points
