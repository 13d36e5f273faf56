"""How axes come to rest as soon as limits of acceleration and jerk allow."""

from station.memory.doubles import Doubles
from station.memory.functions import square_root


def resting_ways(
    velocities: Doubles,
    accelerations: Doubles,
    largest: Doubles,
    jerks: Doubles,
    ways: Doubles,
) -> None:
    """Write how far each axis goes until it rests.

    Args:
        velocities: Present velocities, shape (n,).
        accelerations: Present accelerations, each within its limit, shape (n,).
        largest: Largest accelerations, > 0, shape (n,).
        jerks: Largest jerks, > 0, shape (n,).
        ways: Where the ways go, shape (n,).
    """
    for axis in range(len(ways)):
        v, a, j = velocities[axis], accelerations[axis], jerks[axis]
        if v == 0.0 and a == 0.0:
            ways[axis] = 0.0
            continue
        # The velocity when the acceleration has become zero tells which way to brake.
        sign = 1.0
        if v + (a if a > 0.0 else -a) * a / (2.0 * j) < 0.0:
            sign, v, a = -1.0, -v, -a
        peak = v * j + a * a / 2.0
        peak = square_root(peak) if peak > 0.0 else 0.0
        hold = 0.0
        if peak > largest[axis]:
            peak = largest[axis]
            hold = (v + (a * a / 2.0 - peak * peak) / j) / peak
        # Jerk to the peak, constant acceleration, jerk back to zero.
        t = (a + peak) / j
        way = t * (v + t * (a / 2.0 - t * j / 6.0))
        v = v + t * (a - t * j / 2.0)
        way += hold * (v - hold * peak / 2.0)
        v -= hold * peak
        t = peak / j
        way += t * (v - t * (peak / 2.0 - t * j / 6.0))
        ways[axis] = sign * way


def braking_peaks(
    velocities: Doubles,
    accelerations: Doubles,
    largest: Doubles,
    jerks: Doubles,
    peaks: Doubles,
) -> None:
    """Write the peak acceleration of each axis while it brakes.

    An axis with velocity v and acceleration a that brakes with jerk j reaches
    sqrt(|v| j + a^2 / 2), unless its acceleration limit is smaller.

    Args:
        velocities: Present velocities, shape (n,).
        accelerations: Present accelerations, shape (n,).
        largest: Largest accelerations, > 0, shape (n,).
        jerks: Largest jerks, > 0, shape (n,).
        peaks: Where the accelerations go, against the velocities, shape (n,).
    """
    for axis in range(len(peaks)):
        v, a = velocities[axis], accelerations[axis]
        peak = (v if v > 0.0 else -v) * jerks[axis] + a * a / 2.0
        peak = square_root(peak) if peak > 0.0 else 0.0
        if peak > largest[axis]:
            peak = largest[axis]
        peaks[axis] = peak if v < 0.0 else -peak


def peak_speed(velocities: Doubles, accelerations: Doubles, jerks: Doubles) -> float:
    """Return the length of the vector of the peak speeds of axes that brake.

    Args:
        velocities: Present velocities, shape (n,).
        accelerations: Present accelerations, shape (n,).
        jerks: Largest jerks, > 0, shape (n,).
    """
    total = 0.0
    for axis in range(len(velocities)):
        v, a = velocities[axis], accelerations[axis]
        peak = v + (a if a > 0.0 else -a) * a / (2.0 * jerks[axis])
        v, peak = v * v, peak * peak
        total += peak if peak > v else v
    return square_root(total)
