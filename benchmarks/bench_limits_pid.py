"""What seven PIDs and seven soft limits cost: objects over floats, and NumPy.

Run `python benchmarks/bench_limits_pid.py`. The NumPy rows are the same formulas over
arrays of seven, written as tersely as they can be: the least that NumPy can cost.
"""

import numpy as np
from measuring import REPEATS, median_time, print_table, print_title

from station.core import (
    EffortJointSoftLimitsHandle,
    JointHandle,
    JointLimits,
    JointStateHandle,
    Pid,
    PidGains,
    SoftJointLimits,
)

JOINTS = 7
PERIOD = 0.001
NUMBER = 20_000
ERRORS = [0.01 * index for index in range(JOINTS)]
POSITIONS = [0.3 * index - 1.0 for index in range(JOINTS)]
P, D, K_POSITION, K_VELOCITY = 600.0, 30.0, 100.0, 10.0
MAX_VELOCITY, MAX_EFFORT, BOUND = 2.0, 87.0, 2.8


def time_pids() -> float:
    """Return the time of seven `Pid` objects [us]."""
    pids = [Pid(PidGains(p=P, d=D)) for _ in range(JOINTS)]
    pairs = list(zip(pids, ERRORS, strict=True))

    def run() -> None:
        for pid, error in pairs:
            pid.compute_command(error, PERIOD)

    return median_time(run, NUMBER)


def time_numpy_pids() -> float:
    """Return the time of the same law over arrays [us]."""
    errors, p, i = np.array(ERRORS), np.full(JOINTS, P), np.zeros(JOINTS)
    d, bound = np.full(JOINTS, D), np.zeros(JOINTS)
    previous, integral = np.zeros(JOINTS), np.zeros(JOINTS)

    def run() -> None:
        nonlocal previous, integral
        integral = integral + PERIOD * errors
        rate = (errors - previous) / PERIOD
        previous = errors
        p * errors + np.clip(i * integral, -bound, bound) + d * rate

    return median_time(run, NUMBER)


def time_limits() -> float:
    """Return the time of seven soft-limit handles [us]."""
    velocities, commands = [0.1] * JOINTS, [20.0] * JOINTS
    limits = JointLimits(
        min_position=-BOUND,
        max_position=BOUND,
        max_velocity=MAX_VELOCITY,
        max_effort=MAX_EFFORT,
    )
    soft = SoftJointLimits(-BOUND, BOUND, K_POSITION, K_VELOCITY)
    handles = []
    for index in range(JOINTS):
        state = JointStateHandle(f"j{index}", POSITIONS, velocities, commands, index)
        joint = JointHandle(state, commands)
        handles.append(EffortJointSoftLimitsHandle(joint, limits, soft))

    def run() -> None:
        for handle in handles:
            handle.enforce_limits(PERIOD)

    return median_time(run, NUMBER)


def time_numpy_limits() -> float:
    """Return the time of the same limits over arrays [us]."""
    position, velocity = np.array(POSITIONS), np.full(JOINTS, 0.1)
    command = np.full(JOINTS, 20.0)

    def run() -> None:
        slow = np.clip(-K_POSITION * (position + BOUND), -MAX_VELOCITY, MAX_VELOCITY)
        fast = np.clip(-K_POSITION * (position - BOUND), -MAX_VELOCITY, MAX_VELOCITY)
        low = np.clip(-K_VELOCITY * (velocity - slow), -MAX_EFFORT, MAX_EFFORT)
        high = np.clip(-K_VELOCITY * (velocity - fast), -MAX_EFFORT, MAX_EFFORT)
        np.clip(command, low, high)

    return median_time(run, NUMBER)


def main() -> None:
    """Print the table."""
    print_title(f"Seven joints [us], medians of {REPEATS} repeats")
    rows = [
        ("PID", time_pids(), time_numpy_pids()),
        ("effort soft limits", time_limits(), time_numpy_limits()),
    ]
    print_table(
        ("what", "floats", "NumPy", "NumPy/floats"),
        [(name, floats, arrays, arrays / floats) for name, floats, arrays in rows],
    )


if __name__ == "__main__":
    main()
