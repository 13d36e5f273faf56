"""Desired motion of the follower in a teleoperation: first to align, then to track.

Source: franka_ros@c11f000 franka_example_controllers,
src/teleop_joint_pd_example_controller.cpp, update, saturateAndLimit, rampParameter;
differs: a cycle with a period of 0 moves nothing instead of dividing by zero.
"""

from dataclasses import dataclass
from math import tanh

import numpy as np
from numpy.typing import NDArray

ALIGNMENT_TOLERANCE = 0.01
"""Distance of every joint to the leader's below which the arms are aligned [rad]."""
_ALIGN_P = np.array([45.0, 45.0, 45.0, 45.0, 18.0, 11.0, 5.0])
_ALIGN_D = np.array([4.5, 4.5, 4.5, 4.5, 1.5, 1.5, 1.0])
_ALIGN_VELOCITY = np.full(7, 0.1)
_ALIGN_ACCELERATION = np.full(7, 0.5)
_RAMP_SHIFT = 0.25
_RAMP_INCREASE = 20.0


@dataclass(frozen=True, slots=True)
class MotionBounds:
    """Limits of the follower's motion, shape (7,) each.

    Attributes:
        velocity_far: Largest velocities far behind the leader [rad/s].
        velocity_near: Largest velocities close to the leader [rad/s].
        acceleration_far: Largest accelerations far behind the leader [rad/s^2].
        acceleration_near: Largest accelerations close to the leader [rad/s^2].
    """

    velocity_far: NDArray[np.float64]
    velocity_near: NDArray[np.float64]
    acceleration_far: NDArray[np.float64]
    acceleration_near: NDArray[np.float64]


class FollowerMotion:
    """The desired motion of the follower's joints. Control thread only.

    Args:
        drift_gains: Velocity per distance to the leader [1/s], shape (7,).

    Attributes:
        is_tracking: Whether the arms have been aligned since the start.
        start: Positions of the leader at the start [rad], shape (7,).
        q: Target positions [rad], shape (7,).
        dq: Target velocities [rad/s], shape (7,).
    """

    def __init__(self, drift_gains: NDArray[np.float64]) -> None:
        self._drift_gains = drift_gains
        self.begin_alignment(np.zeros(7), np.zeros(7))

    def begin_alignment(
        self, leader_q: NDArray[np.float64], follower_q: NDArray[np.float64]
    ) -> None:
        """Start to align the follower.

        Args:
            leader_q: Positions of the leader, which is to keep them [rad], shape (7,).
            follower_q: Positions of the follower [rad], shape (7,).
        """
        self.is_tracking = False
        self.start, self.q = leader_q, follower_q
        self.dq = np.zeros(7)
        self._error = leader_q - follower_q

    def update(
        self,
        leader: tuple[NDArray[np.float64], NDArray[np.float64]],
        follower_q: NDArray[np.float64],
        bounds: MotionBounds,
        period: float,
    ) -> None:
        """Advance the desired motion by one period.

        Args:
            leader: Positions [rad] and velocities [rad/s] of the leader, shape (7,)
                each.
            follower_q: Positions of the follower [rad], shape (7,).
            bounds: Limits of the motion while the follower tracks the leader.
            period: Time since the last cycle [s], >= 0.
        """
        q, dq = leader
        if np.abs(q - follower_q).max() < ALIGNMENT_TOLERANCE:
            self.is_tracking = True
        if self.is_tracking:
            behind = np.abs(self.q - q)
            share = np.array([
                ramp(x, 0.0, 1.0, _RAMP_SHIFT, _RAMP_INCREASE) for x in behind
            ])
            velocity = bounds.velocity_near + share * (
                bounds.velocity_far - bounds.velocity_near
            )
            acceleration = bounds.acceleration_near + share * (
                bounds.acceleration_far - bounds.acceleration_near
            )
            wanted = self._drift_gains * (q - self.q) + dq
        else:
            velocity, acceleration = _ALIGN_VELOCITY, _ALIGN_ACCELERATION
            wanted = self._aligning_velocity(follower_q, period)
        step = acceleration * period
        reachable = self.dq + np.clip(wanted - self.dq, -step, step)
        self.dq = np.clip(reachable, -velocity, velocity)
        self.q = self.q + self.dq * period

    def _aligning_velocity(
        self, follower_q: NDArray[np.float64], period: float
    ) -> NDArray[np.float64]:
        last, self._error = self._error, self.start - follower_q
        rate = (self._error - last) / period if period > 0.0 else np.zeros(7)
        result: NDArray[np.float64] = _ALIGN_P * self._error + _ALIGN_D * rate
        return result


def ramp(x: float, low: float, high: float, shift: float, increase: float) -> float:
    """Return a smooth step from `low` to `high` around `shift`.

    Args:
        x: The argument.
        low: Value far below `shift`.
        high: Value far above `shift`.
        shift: Argument at which the value is halfway between `low` and `high`.
        increase: Steepness of the step, > 0.
    """
    return 0.5 * (low + high + (high - low) * tanh(increase * (x - shift)))
