"""External torques and wrench, and the contacts and collisions that follow from them.

The external torque is the reading of a torque sensor minus the torque that the model of
arm, end effector and load needs. It is the torque that the arm exerts on its
environment. MuJoCo knows the forces of contacts and pushes exactly.

Source: Franka Control Interface documentation, RobotState; differs: contact forces are
those of the simulation, so nothing is estimated but the load.
"""

from collections.abc import Callable, Sequence
from math import pi
from typing import TYPE_CHECKING

import numpy as np

from station.core.franka.franka_errors import ArmError
from station.core.franka.franka_model import Frame
from station.core.franka.franka_robot_state import RobotState
from station.core.franka.franka_services import CollisionBehavior
from station.hw.franka.arm.arm_limits import ArmLimits
from station.hw.franka.arm.collision_behavior import (
    DEFAULT_COLLISION_BEHAVIOR,
    collision_error,
)
from station.hw.franka.arm.franka_kinematics import frame_pose, zero_jacobian
from station.hw.mujoco.world_joints import WorldJoints
from station.memory.doubles import put

if TYPE_CHECKING:
    from station.hw.franka.simulated.friction_and_observer import FrictionAndObserver

CUTOFF_FREQUENCY = 100.0
"""Cutoff frequency of the low-pass filter on the external torques [Hz]."""
SINGULAR = 0.05
"""Smallest singular value of the Jacobian for which a wrench is computed; below it the
wrench is 0, because small torques would become arbitrarily large forces."""
# Share of the acceleration limit above which the motion counts as accelerating.
_ACCELERATING = 0.05
# A smaller torque [Nm] is rounding of the simulation. The estimate becomes exactly 0,
# and an arm that nothing touches is not examined.
_NEGLIGIBLE = 1e-6
# Excess of a collision that has not been forgotten yet.
_FADING = 1e-12
_ZEROS = [0.0] * 7


class ContactEstimate:
    """Keeps the external torques and the contact levels of one arm up to date.

    Little is computed while nothing touches the arm. Control thread only.

    Args:
        joints: The arm's joints in the world.
        state: The arm's state; the fields from `tau_ext_hat_filtered` to
            `cartesian_collision` are written.
        limits: The arm's limits.
        load_torques: Returns the torques for the configured load [Nm], shape (7,), or
            None when no load is configured.

    Attributes:
        behavior: The thresholds.
        is_quiet: Whether nothing touches the arm.
        observer: Disturbs the readings in every cycle; None for an ideal arm.
        release: Share of its threshold below which a signal must fall before it can be
            a new collision, at most 1.
        release_cycles: How many cycles in a row all signals must be that low before the
            contact in which the arm recovered has ended.
    """

    def __init__(
        self,
        joints: WorldJoints,
        state: RobotState,
        limits: ArmLimits,
        load_torques: Callable[[], list[float] | None],
    ) -> None:
        self.is_quiet = True
        self.behavior = DEFAULT_COLLISION_BEHAVIOR
        self.observer: FrictionAndObserver | None = None
        self._joints = joints
        self._state = state
        self._gain = joints.timestep / (
            joints.timestep + 1.0 / (2.0 * pi * CUTOFF_FREQUENCY)
        )
        self._accelerating = [_ACCELERATING * a for a in limits.acceleration]
        self._load_torques = load_torques
        self.release = 1.0
        self.release_cycles = 1
        # Excess over its threshold that each signal may have without a new collision:
        # the excess at the last collision or recovery, plus one threshold.
        self._known = [0.0] * 13
        # Whether the contact in which the arm recovered has not ended since. Its force
        # may still turn from one signal to another while the arm comes to rest in it.
        self._lasts = False
        self._released = 0

    def set_behavior(self, behavior: CollisionBehavior) -> None:
        """Take new thresholds over."""
        self.behavior = behavior

    def update(self) -> list[ArmError]:
        """Bring torques, wrench and contacts up to date; return the new collisions."""
        external = self._joints.read_external_forces()
        load = self._load_torques()
        if self.is_quiet and load is None and not any(external):
            return []
        state, gain = self._state, self._gain
        hat = state.doubles("tau_ext_hat_filtered")
        needed = load or _ZEROS
        largest = 0.0
        for i, force in enumerate(external):
            hat[i] += gain * (-force - needed[i] - hat[i])
            largest = max(largest, abs(hat[i]))
        self.is_quiet = largest < _NEGLIGIBLE
        if self.is_quiet:
            put(hat, _ZEROS)
        self._update_wrench()
        return self._update_levels()

    def recover(self) -> None:
        """Forget the collisions; a lasting contact is not counted as a new one."""
        state = self._state
        self._known = self._collisions()
        self._lasts = any(self._known)
        state.joint_collision = _ZEROS
        state.cartesian_collision = [0.0] * 6

    def reset(self) -> None:
        """Start again without any contact."""
        self._state.tau_ext_hat_filtered = _ZEROS
        self.is_quiet = True
        self._known = [0.0] * 13
        self._lasts = False
        self._update_wrench()
        self._update_levels()

    def renew(self) -> None:
        """Take new frames over; nothing is kept that depends on them."""

    def expect_load(self) -> None:
        """Take over the torques for the configured load; `update` asks for them."""

    def react_to(self, found: int) -> bool:
        """Serve the requests of an observer; there is none here.

        Args:
            found: Result of `FrictionAndObserver.sense`, not 0.

        Returns:
            Whether the next command is to be lost on its way.
        """
        del found
        return False

    def _update_wrench(self) -> None:
        state = self._state
        if self.is_quiet:
            state.O_F_ext_hat_K = state.K_F_ext_hat_K = [0.0] * 6
            return
        pose = frame_pose(Frame.STIFFNESS, state.theta, state.F_T_EE, state.EE_T_K)
        jacobian = np.reshape(
            zero_jacobian(Frame.STIFFNESS, state.theta, state.F_T_EE, state.EE_T_K),
            (7, 6),
        )
        # Least squares: J J^T F = J tau.
        gram = jacobian.T @ jacobian
        if np.linalg.eigvalsh(gram)[0] < SINGULAR * SINGULAR:
            state.O_F_ext_hat_K = state.K_F_ext_hat_K = [0.0] * 6
            return
        wrench = np.linalg.solve(
            gram, jacobian.T @ np.array(state.tau_ext_hat_filtered)
        ).tolist()
        state.O_F_ext_hat_K = wrench
        for start in (0, 3):
            x, y, z = wrench[start : start + 3]
            turned = [
                pose[column] * x + pose[column + 1] * y + pose[column + 2] * z
                for column in (0, 4, 8)
            ]
            put(state.doubles("K_F_ext_hat_K")[start : start + 3], turned)

    def _collisions(self) -> list[float]:
        """Return the excess of each signal over its upper threshold.

        The signals are the 7 torques and the 6 components of the wrench. The excess is
        0 for a signal that has been released. One between release and threshold counts
        as a collision that fades: noise alone may lift it over the threshold.
        """
        state = self._state
        torques, forces = self._thresholds(upper=True)
        return [
            max(_FADING, abs(value) - bound)
            if abs(value) > self.release * bound
            else 0.0
            for value, bound in zip(
                (*state.tau_ext_hat_filtered, *state.K_F_ext_hat_K),
                (*torques, *forces),
                strict=True,
            )
        ]

    def _thresholds(
        self, *, upper: bool
    ) -> tuple[tuple[float, ...], tuple[float, ...]]:
        chosen = self.behavior
        if any(
            abs(ddq) > bound
            for ddq, bound in zip(self._state.ddq_d, self._accelerating, strict=True)
        ):
            if upper:
                return (
                    chosen.upper_torque_thresholds_acceleration,
                    chosen.upper_force_thresholds_acceleration,
                )
            return (
                chosen.lower_torque_thresholds_acceleration,
                chosen.lower_force_thresholds_acceleration,
            )
        if upper:
            return (
                chosen.upper_torque_thresholds_nominal,
                chosen.upper_force_thresholds_nominal,
            )
        return (
            chosen.lower_torque_thresholds_nominal,
            chosen.lower_force_thresholds_nominal,
        )

    def _update_levels(self) -> list[ArmError]:
        state = self._state
        torques, forces = self._thresholds(upper=False)
        state.joint_contact = _levels(state.tau_ext_hat_filtered, torques)
        state.cartesian_contact = _levels(state.K_F_ext_hat_K, forces)
        torques, forces = self._thresholds(upper=True)
        values = (*state.tau_ext_hat_filtered, *state.K_F_ext_hat_K)
        found: list[ArmError] = []
        if self._lasts:
            self._released = 0 if any(self._collisions()) else self._released + 1
            self._lasts = self._released < self.release_cycles
            self._known = [max(known, _FADING) for known in self._known]
        for i, bound in enumerate((*torques, *forces)):
            excess = max(0.0, abs(values[i]) - bound)
            # The contact in which the arm recovered must grow by a whole threshold, or
            # it would end every recovery at once.
            if excess > self._known[i] + (bound if self._known[i] else 0.0):
                found.append(collision_error(i, values[i], bound))
                if i < 7:
                    state.doubles("joint_collision")[i] = 1.0
                else:
                    state.doubles("cartesian_collision")[i - 7] = 1.0
                self._known[i] = excess
            fading = self._lasts or (
                self._known[i] and abs(values[i]) > self.release * bound
            )
            self._known[i] = min(self._known[i], max(excess, _FADING if fading else 0))
        return found


def _levels(values: Sequence[float], bounds: Sequence[float]) -> list[float]:
    return [
        1.0 if abs(value) > bound else 0.0
        for value, bound in zip(values, bounds, strict=True)
    ]
