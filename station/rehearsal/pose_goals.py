"""Inverse kinematics: joint positions that bring an end effector to a pose."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from station.core.errors import InvalidCommandError, NoPathError
from station.core.franka.franka_model import Frame
from station.core.franka.franka_services import FrankaServices
from station.core.numerics.arm_chain import least_rates
from station.core.numerics.poses import pose_of, quaternion_of
from station.core.numerics.rigid_motion import twist_between
from station.memory.doubles import Doubles, doubles, zeros
from station.rehearsal.path_search import Joints

if TYPE_CHECKING:
    from station.core.facade.station import Station

_TRIES = 40
"""Number of poses from which the solver starts; the present pose is the first."""
_MOST = 6
"""Number of solutions after which the solver ends: a path to one of them is searched.
"""
_STEPS = 60
_LONGEST = 0.3
"""Largest step of a joint [rad]: a longer Newton step is not reliable."""
_EXACT = 1e-5
"""Largest error of a solution [m, rad]."""
_DAMPING = 1e-5
_APART = 0.1
"""Two solutions whose joints all differ by less are the same [rad]."""
_AT_LIMIT = 1e-3
"""Largest distance from the end of its range at which a joint is at the end [rad]."""


class EndEffector:
    """The end effector of a Franka arm.

    Args:
        arm: The arm.
        joints: Names of its joints.
    """

    def __init__(self, arm: FrankaServices, joints: Sequence[str]) -> None:
        self.joints = list(joints)
        self._model = arm.model().model
        state = arm.get_robot_state()
        self._frames = (state.F_T_EE, state.EE_T_K)

    def pose(self, q: Joints) -> list[float]:
        """Return its pose in the base frame, column-major, shape (16,)."""
        return self._model.pose(Frame.END_EFFECTOR, q.tolist(), *self._frames)

    def jacobian(self, q: Joints) -> list[float]:
        """Return the Jacobian of the end effector, column-major, shape (42,)."""
        return self._model.zero_jacobian(Frame.END_EFFECTOR, q.tolist(), *self._frames)


def end_effectors(station: "Station") -> dict[str, EndEffector]:
    """Return the end effectors of a station's Franka arms, by the arm's name."""
    kind: type[FrankaServices] = FrankaServices  # type: ignore[type-abstract]
    found = {}
    for arm_id in station.robots.names(kind):
        arm = station.robots.get(arm_id, kind)
        if arm is not None:
            names = [f"{arm_id}_joint{number}" for number in range(1, 8)]
            found[arm_id] = EndEffector(arm, names)
    return found


def end_effector_of(
    station: "Station", controller: str, joints: Sequence[str]
) -> EndEffector:
    """Return the end effector of the arm whose joints a controller moves.

    Args:
        station: The station.
        controller: The controller.
        joints: Its joints.

    Raises:
        InvalidCommandError: The joints are not those of a single Franka arm.
    """
    for one in end_effectors(station).values():
        if one.joints == list(joints):
            return one
    raise InvalidCommandError(
        f"'{controller}' does not move the joints of one Franka arm, so that it has no "
        "end effector that could be put to a pose.",
        remedy="Give the positions of joints.",
    )


def target_pose(
    present: Sequence[float],
    position: Sequence[float],
    orientation: Sequence[float] | None,
) -> list[float]:
    """Return the target pose of an end effector, column-major, shape (16,).

    Args:
        present: The present pose, column-major, shape (16,).
        position: Target position [m], shape (3,).
        orientation: Quaternion x, y, z, w of any length but 0; None keeps the present
            one.
    """
    return pose_of(position, orientation or quaternion_of(present))


def joints_at(
    hand: EndEffector,
    target: Sequence[float],
    start: Joints,
    limits: tuple[Joints, Joints],
    names: Sequence[str],
    *,
    seed: int,
    accept: Callable[[Joints], bool],
) -> list[Joints]:
    """Return joint positions that bring the hand to a pose, the nearest ones first.

    Args:
        hand: The end effector.
        target: The pose, column-major, shape (16,).
        start: Present positions [rad], shape (n,).
        limits: Lower and upper ends of the joints' ranges [rad], shape (n,) each.
        names: The joints.
        seed: Seed of the random numbers.
        accept: Returns whether a solution is good; the search ends after enough good
            ones.

    Returns:
        The solutions that `accept` allows; all solutions if it allows none.

    Raises:
        NoPathError: The hand cannot reach the pose.
    """
    random = np.random.default_rng(seed)
    good: list[Joints] = []
    others: list[Joints] = []
    nearest, best = start, np.inf
    goal = doubles(target)
    for k in range(_TRIES):
        begin = start if k == 0 else random.uniform(*limits)
        q, error = _solve(hand, goal, begin, limits)
        if error < best:
            nearest, best = q, error
        known = [*good, *others]
        if error > _EXACT or any(np.abs(q - one).max() < _APART for one in known):
            continue
        (good if accept(q) else others).append(q)
        if len(good) >= _MOST:
            break
    found = good or others
    if found:
        return sorted(found, key=lambda q: float(np.abs(q - start).max()))
    why, details = _left(hand, goal, nearest, limits, names)
    raise NoPathError(
        f"The end effector cannot get there: {why}",
        remedy="Choose a pose that is nearer, or turned otherwise.",
        details={"cause": "unreachable", **details},
    )


def _solve(
    hand: EndEffector, target: Doubles, q: Joints, limits: tuple[Joints, Joints]
) -> tuple[Joints, float]:
    """Take Newton steps; return the last positions, and the error there [m, rad]."""
    error, step, matrix = zeros(6), zeros(len(q)), zeros(36)
    size = np.inf
    for _ in range(_STEPS):
        twist_between(doubles(hand.pose(q)), target, 1.0, error)
        size = float(np.abs(error).max())
        if size < _EXACT:
            break
        least_rates(doubles(hand.jacobian(q)), error, matrix, _DAMPING, step)
        way = np.array(step)
        way *= min(1.0, _LONGEST / max(float(np.abs(way).max()), _LONGEST))
        q = np.clip(q + way, *limits)
    return q, size


def _left(
    hand: EndEffector,
    target: Doubles,
    q: Joints,
    limits: tuple[Joints, Joints],
    names: Sequence[str],
) -> tuple[str, dict[str, object]]:
    """Describe how far a hand is from its target, and the joints that limit it."""
    error = zeros(6)
    twist_between(doubles(hand.pose(q)), target, 1.0, error)
    far, turned = float(np.linalg.norm(error[:3])), float(np.linalg.norm(error[3:]))
    lower, upper = limits
    ends = np.flatnonzero((q - lower < _AT_LIMIT) | (upper - q < _AT_LIMIT))
    stopped = [names[k] for k in ends.tolist()]
    at = f" {', '.join(stopped)} would be at the end of its range." if stopped else ""
    return (
        f"{1e3 * far:.0f} mm and {turned:.2f} rad are left in the nearest pose.{at}",
        {"joints": stopped, "distance": far, "angle": turned},
    )
