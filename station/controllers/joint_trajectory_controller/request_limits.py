"""Refuse trajectories that end too late, lead beyond limits, or are too fast."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from math import comb, isfinite, nan
from operator import mul

from station.core.description.robot_description import JointDescription
from station.core.errors import InvalidTrajectoryError
from station.core.ports.set_point import RANGE_TOLERANCE
from station.core.trajectory import JointTrajectory, JointTrajectorySegment

MAX_DURATION = 86_400.0
"""Latest end of a trajectory from now, and longest goal time tolerance [s]: a day."""
_PEAK_RATIO = 1.1
"""Largest speed between two points over the limit: planners bound the points only."""
_ROUNDING = 1e-6
"""Relative excess that rounding may cause."""
_SHARES = {
    degree: [
        [comb(j, k) / comb(degree, k) for k in range(j + 1)] for j in range(degree + 1)
    ]
    for degree in (4, 5)
}
"""Shares of the powers of time in the control points of a polynomial, by its degree."""


def check_times(request: JointTrajectory, now: float) -> None:
    """Refuse times before the start, and points that are due in over `MAX_DURATION`.

    Times that long come from a wrong unit, such as nanoseconds.

    Args:
        request: The trajectory.
        now: Station time [s].

    Raises:
        InvalidTrajectoryError: A point has such a time.
    """
    ahead = request.stamp - now if request.stamp else 0.0
    for index, point in enumerate(request.points):
        time = point.time_from_start
        if time < 0.0:
            raise InvalidTrajectoryError(
                f"Point {index} has the time_from_start {time:.9g} s, which is before "
                "the start.",
                remedy="Give every point a time_from_start of 0 s or more.",
                details={"point": index, "reason": "past"},
            )
        due = ahead + time
        if due > MAX_DURATION:
            raise InvalidTrajectoryError(
                f"Point {index} is due in {due:.6g} s; allowed are {MAX_DURATION:g} s.",
                remedy="Give times in seconds, not in nanoseconds.",
                details={"point": index, "reason": "duration", "due": due},
            )


def check_positions(
    request: JointTrajectory,
    joints: Sequence[JointDescription],
    here: Mapping[str, Sequence[float]],
) -> None:
    """Refuse positions beyond the limits of a joint.

    A joint may be beyond a limit, e.g. where it rests on its stop. From there it may
    move back, but no further out.

    Args:
        request: The trajectory; every point has one position for each of its joints.
        joints: The joints of the controller.
        here: Where each joint is, by name: commanded and measured [rad or m].

    Raises:
        InvalidTrajectoryError: A position is beyond the joint's limits.
    """
    known = {joint.name: joint for joint in joints}
    for column, name in enumerate(request.joint_names):
        joint = known[name]
        lowest, highest = joint.lower - RANGE_TOLERANCE, joint.upper + RANGE_TOLERANCE
        lower, upper = min(lowest, *here[name]), max(highest, *here[name])
        for index, point in enumerate(request.points):
            position = point.positions[column]
            if not lower <= position <= upper:
                raise InvalidTrajectoryError(
                    f"Point {index} has the position {position} for '{name}'; "
                    f"allowed is {joint.lower} to {joint.upper}.",
                    remedy="Give positions within the limits of the joint.",
                    details={"point": index, "joint": name, "reason": "limits"},
                )
            lower = min(lowest, max(lower, position))
            upper = max(highest, min(upper, position))


def check_segment(joint: JointDescription, segment: JointTrajectorySegment) -> None:
    """Refuse a segment that is too fast for its joint, or leads beyond its limits.

    Both ends of a segment may be allowed while the spline between them is not: it
    swings out when velocities and time do not fit the distance.

    Args:
        joint: The joint; unlimited when its description has no limits.
        segment: The motion from one point to the next.

    Raises:
        InvalidTrajectoryError: The segment is not allowed; `details["reason"]` is
            `pace` or `limits`.
    """
    _, duration, *powers = segment.spline.splines
    start, end = powers[0], segment.end.position[0]
    distance = end - start
    unit = "m" if joint.is_linear() else "rad"
    # `not <=` instead of `>`: NaN compares false, and is refused like this.
    if not abs(distance) <= joint.velocity * duration * (1.0 + _ROUNDING):
        raise InvalidTrajectoryError(
            f"Joint '{joint.name}' would have to move {distance:.6g} {unit} in "
            f"{duration:.6g} s on its way to {end:.6g} {unit}; its limit is "
            f"{joint.velocity:.6g} {unit}/s.",
            remedy="Start the trajectory where the joints are, or give it more time.",
            details={
                "reason": "pace",
                "joint": joint.name,
                "distance": distance,
                "duration": duration,
                "velocity_limit": joint.velocity,
            },
        )
    _check_speed(joint, powers, duration, end)
    _check_range(joint, powers, duration, end)


def _check_speed(
    joint: JointDescription, powers: Sequence[float], duration: float, end: float
) -> None:
    unit = "m" if joint.is_linear() else "rad"
    rates = [power * value for power, value in enumerate(powers)][1:]
    last = sum(rate * duration**power for power, rate in enumerate(rates))
    limit = joint.velocity * (1.0 + _ROUNDING)
    peak = _PEAK_RATIO * joint.velocity
    slowest, fastest = _extremes(rates, duration, -peak, peak)
    velocity = fastest if fastest > -slowest else slowest
    if abs(last) <= limit and -peak <= slowest and fastest <= peak:
        return
    if not abs(last) <= limit:
        velocity = last
    raise InvalidTrajectoryError(
        f"Joint '{joint.name}' would move with {velocity:.6g} {unit}/s on its "
        f"way to {end:.6g} {unit}; its limit is {joint.velocity:.6g} {unit}/s.",
        remedy="Correct the velocities and accelerations of the points, or give the "
        "motion more time.",
        details={
            "reason": "pace",
            "joint": joint.name,
            "velocity": velocity,
            "velocity_limit": joint.velocity,
        },
    )


def _check_range(
    joint: JointDescription, powers: Sequence[float], duration: float, end: float
) -> None:
    unit = "m" if joint.is_linear() else "rad"
    lower = min(joint.lower, powers[0], end) - RANGE_TOLERANCE
    upper = max(joint.upper, powers[0], end) + RANGE_TOLERANCE
    lowest, highest = _extremes(powers, duration, lower, upper)
    if lower <= lowest and highest <= upper:
        return
    position = highest if highest > upper else lowest
    raise InvalidTrajectoryError(
        f"Joint '{joint.name}' would swing out to {position:.6g} {unit} on its way to "
        f"{end:.6g} {unit}; allowed is {joint.lower} to {joint.upper}.",
        remedy="Give points whose velocities fit the distance and the time between "
        "them, or more points.",
        details={"reason": "limits", "joint": joint.name, "position": position},
    )


def _extremes(
    powers: Sequence[float], duration: float, low: float, high: float
) -> tuple[float, float]:
    """Return the least and the greatest value of a polynomial, or `low` and `high`.

    NaN for a polynomial whose values are not finite.

    Args:
        powers: Coefficients of the powers of time, the constant first.
        duration: Where the polynomial ends [s]; it begins at 0.
        low: Returned when no value is less.
        high: Returned when no value is greater.
    """
    scaled, factor = [], 1.0
    for value in powers:
        scaled.append(value * factor)
        factor *= duration
    # The control points of its Bézier curve, whose hull holds the whole polynomial.
    points = [sum(map(mul, row, scaled)) for row in _SHARES[len(powers) - 1]]
    if not isfinite(sum(points)):
        return nan, nan
    slack = _ROUNDING * max(map(abs, points))
    return _extremes_of_curve(points, low, high, slack)


def _extremes_of_curve(
    points: list[float], low: float, high: float, slack: float
) -> tuple[float, float]:
    low, high = min(low, points[0], points[-1]), max(high, points[0], points[-1])
    # Without any slack, rounding would have every half of a flat curve halved again.
    if low - slack <= min(points) and max(points) <= high + slack:
        return low, high
    first, second = [points[0]], [points[-1]]
    while len(points) > 1:  # de Casteljau's algorithm halves the curve
        points = [0.5 * (a + b) for a, b in pairwise(points)]
        first.append(points[0])
        second.append(points[-1])
    low, high = _extremes_of_curve(first, low, high, slack)
    return _extremes_of_curve(second[::-1], low, high, slack)
