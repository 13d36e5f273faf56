"""Compute the metrics of a trial."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from station.core.errors import suggest
from station.core.hardware.robot_report import JointLimitsReport
from station.trials.errors import ExperimentError, UnknownParameterError
from station.trials.trace import Array, Trace
from station.trials.trial import Script
from station.wire.excitations import Step

UNITS: Mapping[str, str] = {
    "rms_error": "rad or m",
    "largest_error": "rad or m",
    "steady_error": "rad or m",
    "rise_time": "s",
    "overshoot": "share of the step",
    "settling_time": "s",
    "effort_peak": "Nm or N",
    "effort_rms": "Nm or N",
    "jerk_rms": "rad/s^3 or m/s^3",
    "energy": "J",
    "limit_margin": "rad or m",
    "reflexes": "",
    "violations": "cycles",
}
"""Unit of each metric. Smaller values are better, except for `limit_margin`."""
LARGER_IS_BETTER = frozenset({"limit_margin"})
_OF_A_STEP = frozenset({"rise_time", "overshoot", "settling_time"})
_STEADY = 0.1
"""Share of a trial, at its end, over which the steady error is averaged."""


@dataclass(frozen=True, slots=True)
class Counts:
    """Counts of a trial that its trace does not have.

    Attributes:
        reflexes: Number of reflexes of arms.
        violations: Number of commands that the gate refused.
    """

    reflexes: int = 0
    violations: int = 0


def check_metric(name: str) -> None:
    """Refuse an unknown metric.

    Raises:
        UnknownParameterError: There is no such metric.
    """
    if name not in UNITS:
        raise UnknownParameterError(
            f"There is no metric '{name}'.", remedy=suggest(name, UNITS)
        )


def measure(
    trace: Trace,
    script: Script,
    limits: Sequence[JointLimitsReport] = (),
    counts: Counts | None = None,
) -> dict[str, float]:
    """Return the metrics of a trial that are finite.

    RMS and peak are taken over all joints of the controller and all cycles.
    `steady_error` is the mean over the last tenth. Only a script whose only motion is a
    step has rise time (10 to 90 %), overshoot and settling time; a step that does not
    rise or settle has no such time.

    Args:
        trace: Recorded motion.
        script: Commanded motion.
        limits: Limits of the robot's joints; `violations` counts cycles beyond them.
        counts: Other counts of the trial.
    """
    counts = counts or Counts()
    error = trace.error[np.isfinite(trace.error).all(axis=1)]
    found = {
        "effort_peak": _largest(trace.effort),
        "effort_rms": _rms(trace.effort),
        "jerk_rms": _rms(np.diff(trace.velocity, 2, axis=0)) / trace.period**2,
        "energy": float(np.abs(trace.effort * trace.velocity).sum() * trace.period),
        "limit_margin": _limit_margin(trace, limits),
        "reflexes": float(counts.reflexes),
        "violations": float(counts.violations + _beyond_limits(trace, limits)),
    }
    if len(error):
        last = error[-max(1, round(_STEADY * len(error))) :]
        found["rms_error"] = _rms(error)
        found["largest_error"] = _largest(error)
        found["steady_error"] = float(np.abs(last).mean())
    step = _only_step(script)
    if step is not None:
        found |= _step_response(trace, step, script.settling_band)
    return {k: found[k] for k in UNITS if k in found and np.isfinite(found[k])}


def check_measured(name: str, script: Script) -> None:
    """Refuse a metric that no trial with this script can have.

    Raises:
        UnknownParameterError: There is no such metric.
        ExperimentError: The metric needs a script whose only motion is a step.
    """
    check_metric(name)
    if name in _OF_A_STEP and _only_step(script) is None:
        raise ExperimentError(
            f"Trials with this script have no '{name}': that is one of a single step.",
            remedy="Use a script whose only motion is a step, or another metric.",
        )


def _only_step(script: Script) -> Step | None:
    """Return the step of a script whose only motion is a step; None for others."""
    match script.motions:
        case [Step() as step]:
            return step
    return None


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2))) if values.size else 0.0


def _largest(values: Array) -> float:
    return float(np.abs(values).max()) if values.size else 0.0


def _limit_margin(trace: Trace, limits: Sequence[JointLimitsReport]) -> float:
    """Return the least distance to a position limit [rad or m]; inf without limits."""
    margin = np.inf
    for report in limits:
        if report.joint not in trace.joints:
            continue
        position = trace.position[:, trace.joints.index(report.joint)]
        low, high = report.limits.min_position, report.limits.max_position
        if low is not None and high is not None and len(position):
            margin = min(
                margin, float(np.minimum(position - low, high - position).min())
            )
    return margin


def _beyond_limits(trace: Trace, limits: Sequence[JointLimitsReport]) -> int:
    """Return the number of cycles in which a joint was beyond a limit."""
    beyond = np.zeros(len(trace.time), bool)
    for report in limits:
        if report.joint not in trace.joints:
            continue
        column = trace.joints.index(report.joint)
        for values, bound in (
            (trace.velocity, report.limits.max_velocity),
            (trace.effort, report.limits.max_effort),
        ):
            if bound is not None:
                beyond |= np.abs(values[:, column]) > bound
    return int(beyond.sum())


def _step_response(trace: Trace, step: Step, band: float) -> dict[str, float]:
    if step.joint not in trace.joints or step.amplitude == 0.0:
        return {}
    begin = int(np.searchsorted(trace.time, step.at))
    if begin >= len(trace.time):
        return {}
    position = trace.position[:, trace.joints.index(step.joint)]
    time = trace.time[begin:] - trace.time[begin]
    way = (position[begin:] - position[begin]) / step.amplitude
    found = {"overshoot": max(0.0, float(way.max()) - 1.0)}
    tenth, nine_tenths = np.argmax(way >= 0.1), np.argmax(way >= 0.9)
    if way.max() >= 0.9:
        found["rise_time"] = float(time[nine_tenths] - time[tenth])
    outside = np.flatnonzero(np.abs(way - 1.0) > band)
    if outside[-1] < len(way) - 1:
        found["settling_time"] = float(time[outside[-1] + 1])
    return found
