"""Identify friction and inertia of a joint from a motion, by least squares."""

import math
from dataclasses import dataclass

import numpy as np

from station.core.errors import suggest
from station.trials.errors import ExperimentError, UnknownParameterError
from station.trials.trace import Array, Trace

_CONFIDENCE = 1.96
"""Number of standard deviations on either side that hold 95 % of a normal distribution.
"""
_LEAST_SPEED = 0.25
"""Share of the largest speed below which the sign of the Coulomb friction is uncertain.
"""
_WORST_CONDITION = 1e4
_FEWEST = 50
"""Smallest number of samples for a fit."""


# Smallest share of the cycles in which a joint must move in each direction.
_LEAST_WAY = 0.1
# Smallest share of each regressor that the others must not explain. Errors of the model
# appear in a parameter divided by this share.
_LEAST_SHARE = 0.02


@dataclass(frozen=True, slots=True)
class Estimate:
    """A number with its confidence interval.

    Attributes:
        value: The number.
        half_width: Half-width of the 95 % interval, >= 0, from the noise and from the
            spread between parts of the motion.
        unit: Unit of both.
    """

    value: float
    half_width: float
    unit: str


@dataclass(frozen=True, slots=True)
class JointModel:
    """`effort = inertia * ddq + viscous * dq + coulomb * sign(dq)`, without gravity.

    Attributes:
        joint: The joint.
        inertia: Inertia of all that moves with the joint [kg m^2 or kg]. It excludes
            the motor's rotor if the robot measures efforts behind the gear, as a Franka
            does.
        viscous: Viscous friction [Nm s/rad or N s/m].
        coulomb: Coulomb friction [Nm or N].
        residual: RMS of the effort that the model does not explain [Nm or N].
        samples: Number of samples of the fit.
    """

    joint: str
    inertia: Estimate
    viscous: Estimate
    coulomb: Estimate
    residual: float
    samples: int


def identify(trace: Trace, joint: str, smoothing: int = 5) -> JointModel:
    """Return the model of a joint that fits a motion best.

    The controller should hold the other joints. The fit includes gravity, as sine and
    cosine of the joint's position, and the coupling to the small motions of the other
    joints, as a multiple of each acceleration. Samples near rest, where Coulomb
    friction is not defined, are left out.

    Args:
        trace: The motion, e.g. a multisine with many reversals.
        joint: The joint.
        smoothing: Half-width of the moving mean that smooths velocities before they are
            differentiated [cycles], >= 0. All other signals get the same mean.

    Raises:
        UnknownParameterError: The motion has no such joint.
        ExperimentError: The motion does not determine the parameters.
    """
    if joint not in trace.joints:
        raise UnknownParameterError(
            f"The motion has no joint '{joint}'.", remedy=suggest(joint, trace.joints)
        )
    column = trace.joints.index(joint)
    # The effort measured in a cycle has acted since the cycle before. It belongs to the
    # acceleration over that period, and to the position and velocity in its middle.
    accelerations = np.diff(trace.velocity, axis=0) / trace.period
    velocity = 0.5 * (trace.velocity[1:, column] + trace.velocity[:-1, column])
    position = 0.5 * (trace.position[1:, column] + trace.position[:-1, column])
    largest = float(np.abs(velocity).max()) if velocity.size else 0.0
    known = np.column_stack([
        np.sin(position),
        np.cos(position),
        np.delete(accelerations, column, axis=1),
    ])
    wanted = np.column_stack([accelerations[:, column], velocity, np.sign(velocity)])
    everything = np.column_stack([wanted, known, trace.effort[1:, column], velocity])
    smooth = _smooth(everything, smoothing)
    # A smoothed sign that is not 1 or -1 belongs to a reversal.
    moving = np.abs(smooth[:, -1]) > _LEAST_SPEED * largest
    moving &= np.abs(np.abs(smooth[:, 2]) - 1.0) < 1e-9
    if largest == 0.0 or moving.sum() < _FEWEST:
        raise ExperimentError(
            f"Joint '{joint}' moves in {int(moving.sum())} cycles; at least {_FEWEST} "
            "are needed.",
            remedy="Excite it for longer, e.g. with a multisine.",
        )
    rows = smooth[moving]
    forwards = float(np.mean(rows[:, 2] > 0.0))
    if not _LEAST_WAY <= forwards <= 1.0 - _LEAST_WAY:
        raise ExperimentError(
            f"Joint '{joint}' moves one way in {max(forwards, 1.0 - forwards):.0%} of "
            f"the cycles; at most {1.0 - _LEAST_WAY:.0%} are usable, because friction "
            "shows in what changes with the direction.",
            remedy="Move it to and fro, e.g. with a multisine.",
        )
    width = (2 * smoothing + 1) * trace.period
    noise = math.sqrt(2.0) * _white_noise(trace.velocity[:, column]) / width
    return _fit(joint, rows[:, :3], rows[:, 3:-2], rows[:, -2], noise)


def _fit(
    joint: str, wanted: Array, known: Array, effort: Array, noise: float
) -> JointModel:
    """Return the least-squares fit.

    Args:
        joint: The joint.
        wanted: Acceleration, velocity and its sign, shape (k, 3).
        known: Other torques that act, shape (k, m).
        effort: The measured efforts [Nm or N], shape (k,).
        noise: Standard deviation of the accelerations [rad/s^2 or m/s^2].

    Raises:
        ExperimentError: The regressors depend on each other.
    """
    # First remove the part that the other regressors explain (Frisch and Waugh), so
    # that the fit has only the three parameters.
    regressors = _without(known, wanted)
    target = _without(known, effort[:, None])[:, 0]
    scale = np.linalg.norm(wanted, axis=0)
    shares = np.linalg.norm(regressors, axis=0) / np.where(scale > 0.0, scale, 1.0)
    condition = float(np.linalg.cond(regressors / np.where(scale > 0.0, scale, 1.0)))
    if shares.min() < _LEAST_SHARE or condition > _WORST_CONDITION:
        raise ExperimentError(
            f"The motion of '{joint}' does not tell inertia and friction apart: the "
            f"condition number is {condition:.3g}, at most {_WORST_CONDITION:g} is "
            f"usable, and {shares.min():.2g} of a regressor is its own, at least "
            f"{_LEAST_SHARE:g} is needed.",
            remedy="Use several frequencies and both directions, e.g. a multisine.",
        )
    found, free = _solve(regressors, target, noise)
    residuals = target - regressors @ found
    freedom = len(target) - len(found) - known.shape[1]
    # Neighbouring residuals are correlated, so fewer of them are independent.
    variance = float(residuals @ residuals) / freedom * _correlation_time(residuals)
    covariance = variance * np.linalg.inv(regressors.T @ regressors)
    spread = _model_error(regressors, target, free, noise)
    widths = np.hypot(_CONFIDENCE * np.sqrt(np.diag(covariance)), spread)
    # If a negative friction was set to 0, its uncertainty includes that change.
    widths = np.maximum(widths, np.abs(free - found))
    units = ("kg m^2 or kg", "Nm s/rad or N s/m", "Nm or N")
    inertia, viscous, coulomb = (
        Estimate(float(value), float(width), unit)
        for value, width, unit in zip(found, widths, units, strict=True)
    )
    residual = math.sqrt(float(np.mean(residuals**2)))
    return JointModel(joint, inertia, viscous, coulomb, residual, len(target))


def _solve(regressors: Array, target: Array, noise: float) -> tuple[Array, Array]:
    """Return the parameters without negative friction, and those of an unbounded fit.

    Noise in a regressor biases its parameter towards zero. The mean square of the
    accelerations contains that of their noise, which is subtracted (W. A. Fuller:
    Measurement Error Models, 1987, section 1.2).
    """
    gram: Array = regressors.T @ regressors
    moment: Array = regressors.T @ target
    # Subtract at most a half: a motion that is hardly above the noise shows no inertia.
    gram[0, 0] -= min(len(target) * noise * noise, 0.5 * gram[0, 0])
    free = np.asarray(np.linalg.solve(gram, moment), np.float64)
    found, kept = free.copy(), [0, 1, 2]
    while found[1:].min() < 0.0:
        kept.remove(1 + int(np.argmin(found[1:])))
        found = np.zeros(3)
        found[kept] = np.linalg.solve(gram[np.ix_(kept, kept)], moment[kept])
    return found, free


def _model_error(regressors: Array, target: Array, free: Array, noise: float) -> Array:
    """Return the spread of each parameter between parts of the motion, shape (3,).

    Effects that the model lacks, such as nonlinear friction, elasticity and coupling,
    are the same at every repetition, so the residuals do not show how far they bias a
    parameter. But the bias differs between slow and fast parts of the motion, and
    between parts with steady and with changing speed.
    """
    speed, direction = np.abs(regressors[:, 1]), regressors[:, 2]
    acceleration = np.abs(regressors[:, 0])
    is_slow = speed < np.median(speed)
    is_steady = acceleration < np.median(acceleration)
    parts = (is_slow, ~is_slow, is_steady, ~is_steady)
    apart = [
        np.abs(_solve(regressors[part], target[part], noise)[1] - free)
        for part in parts
        if np.ptp(direction[part]) > 0.0
    ]
    return np.max(apart, axis=0) / 2.0 if apart else np.zeros(3)


def _white_noise(values: Array) -> float:
    """Return the standard deviation of the white noise in a smooth signal."""
    if len(values) < 4:
        return 0.0
    # A third difference of white noise has 20 times its variance. The few jumps of a
    # motion do not disturb the median.
    return float(np.median(np.abs(np.diff(values, 3)))) / (0.6745 * math.sqrt(20.0))


def _without(known: Array, values: Array) -> Array:
    """Return the part of `values` that the columns of `known` do not explain."""
    scale = np.linalg.norm(known, axis=0)
    scaled = known / np.where(scale > 0.0, scale, 1.0)
    explained, *_ = np.linalg.lstsq(scaled, values, rcond=None)
    left: Array = values - scaled @ explained
    return left


def _correlation_time(residuals: Array) -> float:
    """Return the number of samples over which residuals are correlated, >= 1."""
    centred = residuals - residuals.mean()
    power = float(centred @ centred)
    if power == 0.0:
        return 1.0
    total = 1.0
    for lag in range(1, len(centred) // 4):
        correlation = float(centred[:-lag] @ centred[lag:]) / power
        if correlation <= 0.05:
            break
        total += 2.0 * correlation
    return total


def _smooth(values: Array, half_width: int) -> Array:
    """Return moving means of the columns, shape (k - 2 * half_width, m)."""
    width = 2 * half_width + 1
    kernel = np.full(width, 1.0 / width)
    return np.column_stack([
        np.convolve(column, kernel, mode="valid") for column in values.T
    ])
