"""External torques and wrench, and the contacts and collisions that they show.

The external torque is the reading of a torque sensor minus the torque that the model
expects for arm, end effector and load. It is the torque that the arm exerts on its
environment. MuJoCo knows the forces of contacts and pushes exactly.

Source: Franka Control Interface documentation, RobotState; differs: contact forces are
those of the simulation, so only the load is estimated.
"""

import random
from functools import lru_cache
from math import pi

import numpy as np
from typing_extensions import override

from station.core.franka.franka_errors import ArmError
from station.core.franka.franka_model import Frame
from station.core.franka.franka_robot_state import RobotMode, RobotState
from station.core.franka.franka_services import CollisionBehavior
from station.core.franka.joint_memory import JointMemory
from station.hw.franka.arm.arm_limits import ArmLimits
from station.hw.franka.arm.collision_behavior import (
    DEFAULT_COLLISION_BEHAVIOR,
    NEAR,
    collision_error,
    thresholds_of,
)
from station.hw.franka.arm.franka_kinematics import CHAIN, frame_pose, zero_jacobian
from station.hw.franka.simulated.arm_step import ArmStep
from station.hw.franka.simulated.friction_and_observer import (
    LOST,
    WEAK,
    FrictionAndObserver,
)
from station.hw.franka.simulated.realism import Realism
from station.hw.mujoco.simulator_memory import SimulatorMemory
from station.hw.mujoco.world_joints import WorldJoints
from station.memory.doubles import Doubles, doubles, put

CUTOFF_FREQUENCY = 100.0
"""Cutoff frequency of the low-pass filter on the external torques [Hz]."""
SINGULAR = 0.05
"""Smallest singular value of the Jacobian for which a wrench is computed; below it the
wrench is 0, because small torques would become arbitrarily large forces."""
# Share of the acceleration limit above which the motion counts as accelerating.
_ACCELERATING = 0.05
# Torque below which it counts as rounding of the simulation [Nm]. The estimate then
# becomes exactly 0, and an arm that nothing touches is not examined.
_NEGLIGIBLE = 1e-6
# Excess that stands for a collision which is not forgotten yet.
_FADING = 1e-12
_ZEROS = [0.0] * 7


class ContactEstimate:
    """Keeps the external torques and the contact levels of one arm up to date.

    Little is computed while nothing touches the arm. Control thread only.

    Args:
        joints: The arm's joints in the world.
        state: The arm's state; this class writes the fields from `tau_ext_hat_filtered`
            to `cartesian_collision`.
        limits: The arm's limits.
        step: The arm's cycle; it calls `update` while the arm is not quiet.

    Attributes:
        behavior: The thresholds.
        observer: Disturbs the readings in every cycle; None for an ideal arm.
        release: Share of its threshold to which a signal must fall before it can be a
            new collision, at most 1.
        release_cycles: Number of cycles in a row in which all signals must be released
            until the contact in which the arm recovered has ended.
    """

    def __init__(
        self,
        joints: WorldJoints,
        state: RobotState,
        limits: ArmLimits,
        step: ArmStep,
    ) -> None:
        self.behavior = DEFAULT_COLLISION_BEHAVIOR
        self.observer: FrictionAndObserver | None = None
        self._joints = joints
        self._state = state
        self._gain = joints.timestep / (
            joints.timestep + 1.0 / (2.0 * pi * CUTOFF_FREQUENCY)
        )
        self._accelerating = [_ACCELERATING * a for a in limits.acceleration]
        self._step = step
        self.release = 1.0
        self.release_cycles = 1
        # Known excess of each signal over its threshold, from the last collision or
        # recovery. A new collision must exceed it by another threshold.
        self._known = [0.0] * 13
        # Whether the contact in which the arm recovered still lasts. While the arm
        # comes to rest in it, its force may turn from one signal to another.
        self._lasts = False
        self._released = 0

    def set_behavior(self, behavior: CollisionBehavior) -> None:
        """Use new thresholds."""
        self.behavior = behavior

    def update(self) -> list[ArmError]:
        """Update torques, wrench and contacts; return the new collisions."""
        external = self._joints.read_external_forces()
        load = self._step.load_torques()
        if self._step.is_quiet and load is None and not any(external):
            return []
        state, gain = self._state, self._gain
        hat = state.doubles("tau_ext_hat_filtered")
        needed = load or _ZEROS
        largest = 0.0
        for i, force in enumerate(external):
            hat[i] += gain * (-force - needed[i] - hat[i])
            largest = max(largest, abs(hat[i]))
        self._step.is_quiet = largest < _NEGLIGIBLE
        if self._step.is_quiet:
            put(hat, _ZEROS)
        self._update_wrench()
        if self._state.robot_mode is RobotMode.AUTOMATIC_ERROR_RECOVERY:
            self._accept()
        return self._update_levels()

    def _accept(self) -> None:
        """Count what acts now as known.

        While the arm recovers it only brakes and comes to rest. Otherwise a hand that
        bounces off a table and falls back on it would undo every recovery.
        """
        self._known = [*map(max, self._known, self._collisions())]
        self._lasts = self._lasts or any(self._known)

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
        self._step.is_quiet = True
        self._known = [0.0] * 13
        self._lasts = False
        self._update_wrench()
        self._update_levels()

    def renew(self) -> None:
        """Use new frames, and drop every value that depends on them."""

    def react_to(self, found: int) -> bool:
        """Carry out requests of an observer; this class has no observer.

        Args:
            found: Result of `FrictionAndObserver.sense`, not 0.

        Returns:
            Whether the next command is to be lost on its way.
        """
        del found
        return False

    def _update_wrench(self) -> None:
        state = self._state
        if self._step.is_quiet:
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

        The signals are the 7 torques and the 6 components of the wrench. A released
        signal has the excess 0. A signal between release and threshold counts as a
        collision that fades, because noise alone may lift it over the threshold.
        """
        state = self._state
        return [
            max(_FADING, abs(value) - bound)
            if abs(value) > self.release * bound
            else 0.0
            for value, bound in zip(
                (*state.tau_ext_hat_filtered, *state.K_F_ext_hat_K),
                self._thresholds("upper"),
                strict=True,
            )
        ]

    def _thresholds(self, bound: str) -> tuple[float, ...]:
        pairs = zip(self._state.ddq_d, self._accelerating, strict=True)
        is_accelerating = any(abs(ddq) > most for ddq, most in pairs)
        phase = "acceleration" if is_accelerating else "nominal"
        return thresholds_of(self.behavior, bound, phase)

    def _update_levels(self) -> list[ArmError]:
        state = self._state
        values = (*state.tau_ext_hat_filtered, *state.K_F_ext_hat_K)
        levels = [
            1.0 if abs(value) > bound else 0.0
            for value, bound in zip(values, self._thresholds("lower"), strict=True)
        ]
        state.joint_contact, state.cartesian_contact = levels[:7], levels[7:]
        found: list[ArmError] = []
        if self._lasts:
            self._released = 0 if any(self._collisions()) else self._released + 1
            self._lasts = self._released < self.release_cycles
            self._known = [max(known, _FADING) for known in self._known]
        for i, bound in enumerate(self._thresholds("upper")):
            excess = max(0.0, abs(values[i]) - bound)
            # The contact in which the arm recovered must grow by a whole threshold;
            # otherwise it would end every recovery at once.
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


_NUMBERS = 16384
"""Count of random numbers that noise is drawn from."""
_RELEASE_TIME = 0.1
"""Time for which all signals must be released until the contact in which the arm
recovered has ended [s]. Without it, near a singular pose, the noise of some newtons
would end a contact of 19 N for a cycle, and begin it again as a new collision."""
_REACH = 0.01
"""Largest turn of a joint until the Jacobian is computed anew [rad]; such a turn
changes the wrench by 1 %."""
_RELIABLE = 0.13
"""Singular value of the Jacobian above which the torques determine the wrench well.

Below it, errors of sensors and model would look like contacts in free space: of 1000
random motions in the whole range of the joints, 1 in 30 ended in a reflex.
"""
_LASTING = 0.2
"""Time after which a change of the torques counts as lasting [s]: long compared with
the 0.05 s in which a collision is found, short compared with a motion, in which errors
change."""


class MomentumObserver(ContactEstimate):
    """Estimates external torques and contact levels as a real arm's observer does.

    Control thread only.

    Args:
        joints: The arm's joints in the world.
        state: The arm's state.
        limits: The arm's limits.
        step: As for `ContactEstimate`.
        realism: Disturbances of the arm.
        memory: State of the joints.
        simulator: The simulator's memory of the joints.

    Attributes:
        observer: Applies the joints' friction, disturbs the readings, and estimates the
            external torques.
    """

    def __init__(
        self,
        joints: WorldJoints,
        state: RobotState,
        limits: ArmLimits,
        step: ArmStep,
        realism: Realism,
        memory: JointMemory,
        simulator: SimulatorMemory,
    ) -> None:
        super().__init__(joints, state, limits, step)
        self.observer: FrictionAndObserver = FrictionAndObserver(
            memory,
            simulator,
            realism,
            fields=state.doubles,
            chain=CHAIN,
            noise=_random_numbers(realism.seed),
            period=joints.timestep,
        )
        self.observer.reach = _REACH
        self.observer.singular, self.observer.reliable = SINGULAR, _RELIABLE
        self.observer.lasting_gain = joints.timestep / (joints.timestep + _LASTING)
        self._torque_error = realism.torque_error
        self._dice = random.Random(realism.seed)
        self._losses = realism.losses
        self._seed = realism.seed
        # During a recovery, and for three time constants after it, nothing is a new
        # collision, because the estimate still approaches the acting torques.
        self._settling_time = 3.0 / (2.0 * pi * realism.observer_frequency)
        # In the arm's time, which passes even while nothing touches the arm.
        self._settled_at = 0.0
        self.set_behavior(self.behavior)
        # Otherwise noise would make a fading signal count again and again.
        self.release = NEAR
        self.release_cycles = round(_RELEASE_TIME / joints.timestep)

    @override
    def set_behavior(self, behavior: CollisionBehavior) -> None:
        super().set_behavior(behavior)
        nominal = thresholds_of(behavior, "lower", "nominal")
        accelerating = thresholds_of(behavior, "lower", "acceleration")
        # The smaller threshold: the observer only requests `update`, which knows
        # whether the motion accelerates, and decides.
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
        if self._step.is_quiet:
            return []
        if self._state.robot_mode is RobotMode.AUTOMATIC_ERROR_RECOVERY:
            self._settled_at = self._state.time + self._settling_time
        if self._state.time < self._settled_at:
            self._accept()
        found = self._update_levels()
        state = self._state
        self._step.is_quiet = not (
            any(state.joint_contact) or any(state.cartesian_contact) or any(self._known)
        )
        return found

    @override
    def recover(self) -> None:
        super().recover()
        self._settled_at = self._state.time + self._settling_time

    @override
    def reset(self) -> None:
        self.observer.rest()
        self._settled_at = 0.0
        self.renew()
        # So that a run after a reset loses the same commands again.
        self._dice.seed(self._seed)
        self._draw_loss()
        super().reset()

    @override
    def _update_wrench(self) -> None:
        """Do nothing, because `FrictionAndObserver` has computed the wrench."""

    @override
    def renew(self) -> None:
        if self.observer.renew_jacobian():
            self._find_weak_directions()

    def _find_weak_directions(self) -> None:
        """Find the directions in which errors of the torques look like forces.

        An error along one direction looks like a wrench of the error divided by the
        singular value. Only the excess over this wrench at the singular value
        `_RELIABLE` is in doubt, so that the result has no step there.
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
        """Draw the number of cycles until the next lost command."""
        if self._losses > 0.0:
            wait = self._dice.expovariate(self._losses)
            self.observer.cycles_to_loss = 1 + round(wait)


# Arms with the same seed share the numbers, because drawing them takes 5 ms. Only a few
# sets are kept, because random trials use a new seed each time.
@lru_cache(maxsize=8)
def _random_numbers(seed: int) -> Doubles:
    dice = random.Random(seed)
    return doubles(dice.gauss(0.0, 1.0) for _ in range(_NUMBERS))
