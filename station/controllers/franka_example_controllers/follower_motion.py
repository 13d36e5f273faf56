"""Where the follower of a teleoperation shall be: first aligned, then on the track.

Source: franka_ros@c11f000 franka_example_controllers,
src/teleop_joint_pd_example_controller.cpp, update, saturateAndLimit, rampParameter;
differs: a cycle without duration moves nothing instead of dividing by zero.
"""

from dataclasses import dataclass
from math import tanh

import numpy as np
from numpy.typing import NDArray

ALIGNMENT_TOLERANCE = 0.01
"""Every joint of the follower this close to the leader's: aligned [rad]."""
_ALIGN_P = np.array([45.0, 45.0, 45.0, 45.0, 18.0, 11.0, 5.0])
_ALIGN_D = np.array([4.5, 4.5, 4.5, 4.5, 1.5, 1.5, 1.0])
_ALIGN_VELOCITY = np.full(7, 0.1)
_ALIGN_ACCELERATION = np.full(7, 0.5)
_RAMP_SHIFT = 0.25
_RAMP_INCREASE = 20.0


@dataclass(frozen=True, slots=True)
class MotionBounds:
    """How fast the follower may move; shape (7,) each.

    Attributes:
        velocity_far: Far behind the leader [rad/s].
        velocity_near: Close to it [rad/s].
        acceleration_far: Far behind [rad/s^2].
        acceleration_near: Close [rad/s^2].
    """

    velocity_far: NDArray[np.float64]
    velocity_near: NDArray[np.float64]
    acceleration_far: NDArray[np.float64]
    acceleration_near: NDArray[np.float64]


class FollowerMotion:
    """Targets of the follower's joints. Control thread only.

    Args:
        drift_gains: How fast what is missing to the leader is made up for [1/s], (7,).

    Attributes:
        is_tracking: The arms have been aligned.
        start: Where the leader was at the start [rad], shape (7,).
        q: Target positions [rad], shape (7,).
        dq: Target velocities [rad/s], shape (7,).
    """

    def __init__(self, drift_gains: NDArray[np.float64]) -> None:
        self._drift_gains = drift_gains
        self.begin(np.zeros(7), np.zeros(7))

    def begin(
        self, leader_q: NDArray[np.float64], follower_q: NDArray[np.float64]
    ) -> None:
        """Align from now on.

        Args:
            leader_q: Where the leader is, and is to stay [rad], shape (7,).
            follower_q: Where the follower is [rad], shape (7,).
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
        """Move the targets on.

        Args:
            leader: Positions [rad] and velocities [rad/s], shape (7,) each.
            follower_q: Positions [rad], shape (7,).
            bounds: How fast the targets may move on the track.
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
        x: Where on the step.
        low: Value far below `shift`.
        high: Value far above.
        shift: Where the value is in the middle.
        increase: How steep the step is, > 0.
    """
    return 0.5 * (low + high + (high - low) * tanh(increase * (x - shift)))
