"""Sample splines of several joints at one time: polynomials of degree 5 at most.

A spline has `SPLINE_SIZE` numbers: the time at its start and its duration [s], and the
coefficients of its powers of time, the constant first.

Source: ros_controllers@678b92a joint_trajectory_controller/include/
trajectory_interface/quintic_spline_segment.h.
"""

from station.memory.doubles import Doubles, Storage

SPLINE_SIZE = 8
"""Numbers of a spline."""


def sample_splines(splines: Storage, time: float, states: Doubles) -> bool:
    """Compute positions, velocities and accelerations at a time.

    Before its start and after its end, a spline rests at the nearer end.

    Args:
        splines: The splines one after the other, shape (8 n,). Each one has its start
            and duration [s], then the coefficients of the powers 0 to 5 of the time
            since its start.
        time: The time [s].
        states: Receives n positions, then n velocities, then n accelerations,
            shape (3 n,).

    Returns:
        Whether all splines rest at their ends.
    """
    n = len(states) // 3
    is_over = True
    # The powers of time are computed anew where a spline has another time than the one
    # before; NaN equals no time.
    start = duration = float("nan")
    t1 = t2 = t3 = t4 = t5 = v2 = v3 = v4 = v5 = a3 = a4 = a5 = 0.0
    before = beyond = False
    at = 0
    for k in range(n):
        if splines[at] != start or splines[at + 1] != duration:
            start = splines[at]
            duration = splines[at + 1]
            t1 = time - start
            before = t1 < 0.0
            beyond = t1 > duration
            if beyond:
                t1 = duration
            t2 = t1 * t1
            t3 = t2 * t1
            t4 = t3 * t1
            t5 = t4 * t1
            v2 = 2.0 * t1
            v3 = 3.0 * t2
            v4 = 4.0 * t3
            v5 = 5.0 * t4
            a3 = 6.0 * t1
            a4 = 12.0 * t2
            a5 = 20.0 * t3
        c0 = splines[at + 2]
        if before:
            is_over = False
            states[k] = c0
            states[n + k] = 0.0
            states[n + n + k] = 0.0
        else:
            c1 = splines[at + 3]
            c2 = splines[at + 4]
            c3 = splines[at + 5]
            c4 = splines[at + 6]
            c5 = splines[at + 7]
            states[k] = c0 + t1 * c1 + t2 * c2 + t3 * c3 + t4 * c4 + t5 * c5
            if beyond:
                states[n + k] = 0.0
                states[n + n + k] = 0.0
            else:
                is_over = False
                states[n + k] = c1 + v2 * c2 + v3 * c3 + v4 * c4 + v5 * c5
                states[n + n + k] = 2.0 * c2 + a3 * c3 + a4 * c4 + a5 * c5
        at += 8
    return is_over
