"""Contacts as a real arm sees them: through noisy sensors and a model with errors."""

import random
from collections.abc import Callable
from math import pi

import numpy as np
from typing_extensions import override

from station.core.franka.franka_errors import ArmError
from station.core.franka.franka_robot_state import RobotMode, RobotState
from station.core.franka.franka_services import CollisionBehavior
from station.core.franka.joint_memory import JointMemory
from station.hw.franka.arm.arm_limits import ArmLimits
from station.hw.franka.arm.collision_behavior import NEAR
from station.hw.franka.arm.franka_kinematics import CHAIN
from station.hw.franka.simulated.contact_estimate import SINGULAR, ContactEstimate
from station.hw.franka.simulated.friction_and_observer import (
    LOST,
    WEAK,
    FrictionAndObserver,
)
from station.hw.franka.simulated.realism import Realism
from station.hw.mujoco.simulator_memory import SimulatorMemory
from station.hw.mujoco.world_joints import WorldJoints
from station.memory.doubles import Doubles, doubles, put

_NUMBERS = 16381
"""How many random numbers there are. They are drawn in pairs of a cycle's 14, and the
number is prime, so a joint gets the same ones again after 16 s at the earliest."""
_RELEASE_TIME = 0.1
"""How long all signals must be that low until the contact in which the arm recovered
has ended [s]: near a singular pose the noise of some newtons would end a contact of
19 N for a cycle, and begin it again as a new collision."""
_REACH = 0.01
"""How far a joint may turn until the Jacobian is computed anew [rad]: 1 % of wrench."""
_RELIABLE = 0.13
"""Singular value of the Jacobian above which the wrench is the one of the torques.

Below, errors of sensors and model are taken for contacts in free space otherwise: of
1000 random motions in the whole range of the joints 1 in 30 ended in a reflex.
"""
_LASTING = 0.2
"""Time after which a change of the torques counts as lasting [s]: long beside the
0.05 s in which a collision is found, short beside a motion, in which errors change."""


class MomentumObserver(ContactEstimate):
    """Keeps external torques and contact levels up to date as an observer finds them.

    Control thread only.

    Args:
        joints: The arm's joints in the world.
        state: The arm's state.
        limits: The arm's limits.
        load_torques: As for `ContactEstimate`.
        realism: Disturbances of the arm.
        memory: State of the joints.
        simulator: The simulator's memory of the joints.

    Attributes:
        observer: Lets the joints' friction act, disturbs the readings, and estimates
            the torques that act from outside.
    """

    def __init__(
        self,
        joints: WorldJoints,
        state: RobotState,
        limits: ArmLimits,
        load_torques: Callable[[], list[float] | None],
        realism: Realism,
        memory: JointMemory,
        simulator: SimulatorMemory,
    ) -> None:
        super().__init__(joints, state, limits, load_torques)
        self.observer: FrictionAndObserver = FrictionAndObserver(
            memory,
            simulator,
            chain=CHAIN,
            tool=state.doubles("F_T_EE"),
            stiffness_frame=state.doubles("EE_T_K"),
            noise=_random_numbers(realism.seed),
            estimate=state.doubles("tau_ext_hat_filtered"),
            theta=state.doubles("theta"),
            wrench=state.doubles("O_F_ext_hat_K"),
            turned=state.doubles("K_F_ext_hat_K"),
            period=joints.timestep,
        )
        _set(self.observer, realism, joints.timestep)
        self._torque_error = realism.torque_error
        self._dice = random.Random(realism.seed)
        self._losses = realism.losses
        self._seed = realism.seed
        # Nothing is a new collision in a recovery, and for three time constants after
        # it, in which the estimate still approaches what acts.
        self._settling_time = 3.0 / (2.0 * pi * realism.observer_frequency)
        # By the arm's time, which goes on while nothing touches the arm.
        self._settled_at = 0.0
        self.set_behavior(self.behavior)
        # A signal that fades through noise would be counted again and again.
        self.release = NEAR
        self.release_cycles = round(_RELEASE_TIME / joints.timestep)

    @override
    def set_behavior(self, behavior: CollisionBehavior) -> None:
        super().set_behavior(behavior)
        nominal = (
            *behavior.lower_torque_thresholds_nominal,
            *behavior.lower_force_thresholds_nominal,
        )
        accelerating = (
            *behavior.lower_torque_thresholds_acceleration,
            *behavior.lower_force_thresholds_acceleration,
        )
        # The smaller one: the observer only asks for `update`, which knows whether the
        # motion accelerates, and decides.
        put(self.observer.lower, map(min, nominal, accelerating))

    @override
    def react_to(self, found: int) -> bool:
        if found & WEAK:
            self._find_weak_directions()
        if found & LOST:
            self._draw_loss()
            return True
        return False

    @override
    def update(self) -> list[ArmError]:
        if self.is_quiet:
            return []
        if self._state.robot_mode is RobotMode.AUTOMATIC_ERROR_RECOVERY:
            # The arm only brakes and comes to rest; a hand that bounces off a table and
            # falls back on it would otherwise undo every recovery.
            self._settled_at = self._state.time + self._settling_time
        if self._state.time < self._settled_at:
            self._known = [*map(max, self._known, self._collisions())]
            self._lasts = self._lasts or any(self._known)
        found = self._update_levels()
        state = self._state
        self.is_quiet = not (
            any(state.joint_contact) or any(state.cartesian_contact) or any(self._known)
        )
        return found

    @override
    def expect_load(self) -> None:
        put(self.observer.expected, self._load_torques() or [0.0] * 7)

    @override
    def recover(self) -> None:
        super().recover()
        self._settled_at = self._state.time + self._settling_time

    @override
    def reset(self) -> None:
        self.observer.rest()
        self._settled_at = 0.0
        self.renew()
        # A re-run after a reset loses the same commands again.
        self._dice.seed(self._seed)
        self._draw_loss()
        super().reset()

    @override
    def _update_wrench(self) -> None:
        """Nothing is left to do: `FrictionAndObserver` has computed the wrench."""

    @override
    def renew(self) -> None:
        if self.observer.renew_jacobian():
            self._find_weak_directions()

    def _find_weak_directions(self) -> None:
        """Find the directions in which errors of the torques look like forces.

        An error along one direction of the joints looks like a wrench of the error over
        the singular value. Only what exceeds that at `_RELIABLE` is in doubt, so that
        the wrench has no step there.
        """
        observer = self.observer
        jacobian = np.reshape(observer.jacobian, (7, 6))
        squares, directions = np.linalg.eigh(jacobian.T @ jacobian)
        weak = int(np.searchsorted(squares, _RELIABLE * _RELIABLE))
        values, directions = np.sqrt(squares[:weak]), directions[:, :weak]
        shares = jacobian @ directions / squares[:weak]  # (7, weak)
        put(observer.directions[: 6 * weak], directions.T.ravel())
        put(observer.shares[: 7 * weak], shares.T.ravel())
        put(
            observer.doubt[:weak], self._torque_error * (1.0 / values - 1.0 / _RELIABLE)
        )
        observer.weak = weak

    def _draw_loss(self) -> None:
        """Draw after how many cycles the next command is lost."""
        if self._losses > 0.0:
            wait = self._dice.expovariate(self._losses)
            self.observer.cycles_to_loss = 1 + round(wait)


def _random_numbers(seed: int) -> Doubles:
    dice = random.Random(seed)
    return doubles(dice.gauss(0.0, 1.0) for _ in range(_NUMBERS))


def _set(observer: FrictionAndObserver, realism: Realism, period: float) -> None:
    put(observer.level, realism.friction_level)
    put(observer.slope, realism.friction_slope)
    put(observer.shift, realism.friction_shift)
    put(observer.viscous, realism.viscous)
    observer.stribeck_velocity = realism.stribeck_velocity
    observer.presliding = realism.presliding
    put(observer.static_friction, realism.static_friction)
    put(observer.compliance, [1.0 / stiffness for stiffness in realism.joint_stiffness])
    put(observer.torque_noise, realism.torque_noise)
    put(observer.torque_bias, realism.torque_bias)
    put(observer.velocity_noise, realism.velocity_noise)
    put(observer.model_error, realism.model_error)
    observer.reach = _REACH
    observer.singular, observer.reliable = SINGULAR, _RELIABLE
    observer.lasting_gain = period / (period + _LASTING)
    observer.gain = period / (period + 1.0 / (2.0 * pi * realism.observer_frequency))
    observer.settle()
