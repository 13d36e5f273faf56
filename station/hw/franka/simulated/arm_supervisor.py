"""Find errors in the measured state of an arm, and keep them, as a real arm does.

Source: Franka Control Interface documentation, Errors; libfranka@0.9.2
include/franka/errors.h; differs: thresholds that Franka does not publish are in
`SupervisorLimits`.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import sqrt

from station.core.franka.franka_errors import ERROR_INDEX, ArmError
from station.core.franka.franka_model import Frame
from station.core.franka.franka_robot_state import RobotState
from station.core.franka.franka_services import ArmRecord
from station.core.numerics.poses import rotation_between, times
from station.hw.franka.arm.arm_limits import ArmLimits
from station.hw.franka.arm.franka_kinematics import frame_pose, zero_jacobian
from station.hw.franka.arm.self_collision import clearance
from station.hw.franka.arm.supervisor_limits import SupervisorLimits
from station.hw.franka.simulated.cycle_log import CycleLog
from station.hw.franka.simulated.joint_watch import JointWatch
from station.hw.franka.simulated.simulated_cycles import AlertFlag
from station.memory.doubles import Doubles

# Change for the worse after a recovery that makes a value an error again [rad or m];
# for other units a share of the limit.
_WORSE = 0.005
_WORSE_SHARE = 0.1


class ArmSupervisor(AlertFlag):
    """Finds errors in the measured state, and keeps those of the arm.

    A value that is still out of its range when the arm recovers, such as a joint beyond
    its limit, becomes an error again only when it moves further out, so that the arm
    can be moved back.

    The distances of links and end effector are computed only when the joints may have
    turned far enough since the last computation to bring them too close.

    Control thread only.

    Args:
        state: The arm's state; `current_errors` and `last_motion_errors` are written.
        limits: The arm's limits.
        thresholds: Thresholds that Franka does not publish.
        watch: Looks at the readings in every cycle.
        cycle_log: The last cycles.
        positions: Positions of the joints as they are [rad], shape (7,).

    Attributes:
        errors: The present errors with their causes; empty after a recovery.
        last_motion_errors: The errors that ended the last motion.
        log: The last cycles before the last error.
        has_hand: Whether a hand is mounted.
        is_alert: Whether something was unusual in the cycle before.
    """

    def __init__(
        self,
        state: RobotState,
        limits: ArmLimits,
        thresholds: SupervisorLimits,
        watch: JointWatch,
        cycle_log: CycleLog,
        positions: Doubles,
    ) -> None:
        super().__init__()
        self._state = state
        self._positions = positions
        self._limits = limits
        self._thresholds = thresholds
        self._watch = watch
        self._cycle_log = cycle_log
        slack = thresholds.position_tolerance
        self._lower = [value - slack for value in limits.lower]
        self._upper = [value + slack for value in limits.upper]
        self._velocity = [v * thresholds.velocity_factor for v in limits.velocity]
        self._torque = [t * thresholds.torque_factor for t in limits.torque]
        self._speed = limits.translation.velocity * thresholds.velocity_factor
        self._bad_cycles = 0
        self._known: dict[tuple[str, str], float] = {}
        self.errors: list[ArmError] = []
        self.last_motion_errors: list[ArmError] = []
        self.log: list[ArmRecord] = []
        self.has_hand = False

    def examine(
        self, *, is_quiet: bool, is_following: bool, is_recovering: bool
    ) -> list[ArmError]:
        """Look closer at a cycle that the watch has looked at.

        Args:
            is_quiet: Whether the watch has found everything in order.
            is_following: Whether the arm follows a desired motion.
            is_recovering: Whether the arm only brakes and comes to rest: what is out of
                range then is accepted, or a push that lasts would undo every recovery.

        Returns:
            Errors of measured values that were out of range for too long.
        """
        q = list(self._positions)
        if is_quiet and not (self._limits.curves and self._is_fast_near_limits(q)):
            self._bad_cycles = 0
            self._known = {}
            self.is_alert = False
            return []
        self.is_alert = True
        power = self._watch.total_power
        if is_recovering:
            self._accept(q, power)
            return []
        found = self._new(self._find(q, power, is_following=is_following))
        self._bad_cycles = self._bad_cycles + 1 if found else 0
        return found if self._bad_cycles >= self._thresholds.debounce else []

    def set_errors(self, errors: Sequence[ArmError], cycle: int) -> None:
        """Raise errors; an error that is present already does not change.

        Args:
            errors: The errors.
            cycle: Number of the arm's cycle.
        """
        state = self._state
        if not self.errors:
            self.log = [
                ArmRecord(
                    time,
                    tuple(q),
                    tuple(dq),
                    tuple(tau),
                    tuple(q_d),
                    tuple(tau_d),
                    tuple(command),
                )
                for time, states, command in self._cycle_log.cycles()
                for q, dq, tau, _, q_d, _, _, tau_d in (states,)
            ]
        known = {(error.name, error.where) for error in self.errors}
        for error in errors:
            if (error.name, error.where) not in known:
                self.errors.append(replace(error, cycle=cycle))
            state.current_errors[ERROR_INDEX[error.name]] = True

    def begin_motion(self) -> None:
        """Forget the errors that ended the motion before."""
        self.clear()
        self.end_motion()

    def end_motion(self) -> None:
        """Note that the present errors, if any, have ended a motion."""
        self.last_motion_errors = list(self.errors)
        self._state.last_motion_errors[:] = self._state.current_errors

    def clear(self) -> None:
        """Forget the present errors, but keep the errors that ended the last motion."""
        self.errors = []
        self._state.current_errors[:] = [False] * len(self._state.current_errors)
        self._bad_cycles = 0
        self._cycle_log.clear()

    def recover(self) -> None:
        """Forget the present errors, and accept values that are out of range now."""
        self.clear()
        q, state = list(self._positions), self._state
        power = sum(
            abs(dq * tau) for dq, tau in zip(state.dtheta, state.tau_J, strict=True)
        )
        self._watch.room = 0.0
        self._accept(q, power)
        self.is_alert = True

    def _accept(self, q: Sequence[float], power: float) -> None:
        """Take what is out of range now for known."""
        found = self._find(q, power, is_following=False)
        self._known = {(e.name, e.where): _excess(e) for e in found}

    def look_again(self) -> None:
        """Compute all distances in the next cycle: the arm was set to a new pose."""
        self._watch.room = 0.0
        self._known = {}

    def _is_fast_near_limits(self, q: Sequence[float]) -> bool:
        """Return whether a joint is too fast for its position.

        Source: `ArmLimits.curves`.
        """
        for i, velocity in enumerate(self._state.dtheta):
            slowest, fastest = self._limits.velocity_range(i, q[i])
            slack = self._velocity[i] - self._limits.velocity[i]
            if not slowest - slack <= velocity <= fastest + slack:
                return True
        return False

    def _new(self, found: list[ArmError]) -> list[ArmError]:
        """Return the errors that are new, or worse, since the last recovery."""
        known = self._known
        if not known:
            return found
        self._known = {
            key: min(known[key], _excess(error))
            for error in found
            if (key := (error.name, error.where)) in known
        }
        return [
            error
            for error in found
            if (key := (error.name, error.where)) not in known
            or _excess(error) > known[key] + _tolerance(error)
        ]

    def _find(
        self, q: Sequence[float], power: float, *, is_following: bool
    ) -> list[ArmError]:
        found = self._find_in_joints(q)
        found += self._find_too_close(q)
        state, limits = self._state, self._limits
        twist = times(zero_jacobian(Frame.END_EFFECTOR, q, state.F_T_EE), state.dtheta)
        speed = sqrt(sum(value * value for value in twist[:3]))
        if speed > self._speed:
            bound = limits.translation.velocity
            name = "cartesian_velocity_violation"
            found.append(ArmError(name, "end effector", speed, bound, "m/s"))
        if power > self._thresholds.power:
            bound = self._thresholds.power
            found.append(ArmError("power_limit_violation", "", power, bound, "W"))
        if is_following:
            found += self._find_deviations(q)
        return found

    def _find_in_joints(self, q: Sequence[float]) -> list[ArmError]:
        state, limits = self._state, self._limits
        found: list[ArmError] = []
        for i, position in enumerate(q):
            joint = f"joint{i + 1}"
            velocity, tau = state.dtheta[i], state.tau_J[i]
            if not self._lower[i] <= position <= self._upper[i]:
                bound = min(limits.upper[i], self._upper[i])
                if position < self._lower[i]:
                    bound = max(limits.lower[i], self._lower[i])
                name = "joint_position_limits_violation"
                found.append(ArmError(name, joint, position, bound, "rad"))
            slowest, fastest = limits.velocity_range(i, position)
            slack = self._velocity[i] - limits.velocity[i]
            if not slowest - slack <= velocity <= fastest + slack:
                bound = fastest if velocity > 0.0 else slowest
                name = "joint_velocity_violation"
                found.append(ArmError(name, joint, velocity, bound, "rad/s"))
            if abs(tau) > self._torque[i]:
                bound = self._torque[i]
                found.append(ArmError("tau_j_range_violation", joint, tau, bound, "Nm"))
        return found

    def _find_too_close(self, q: Sequence[float]) -> list[ArmError]:
        """Compute the distances between links and to walls if they may be too short."""
        if self._watch.room > 0.0:
            return []
        limits, found = self._thresholds, []
        nearest = clearance(q, has_hand=self.has_hand)
        least = limits.self_collision_distance
        room = nearest.distance - least
        if room < 0.0:
            name = "self_collision_avoidance_violation"
            found.append(ArmError(name, nearest.links, nearest.distance, least, "m"))
        position = frame_pose(Frame.END_EFFECTOR, q, self._state.F_T_EE)[12:15]
        for axis, value, low, high in zip(
            "xyz", position, limits.cartesian_lower, limits.cartesian_upper, strict=True
        ):
            room = min(room, value - low, high - value)
            if not low <= value <= high:
                name = "cartesian_position_limits_violation"
                bound = low if value < low else high
                found.append(ArmError(name, axis, value, bound, "m"))
        self._watch.room = room
        return found

    def _find_deviations(self, q: Sequence[float]) -> list[ArmError]:
        state = self._state
        pose = frame_pose(Frame.END_EFFECTOR, q, state.F_T_EE)
        desired = frame_pose(Frame.END_EFFECTOR, state.q_d, state.F_T_EE)
        shift = [desired[i] - pose[i] for i in (12, 13, 14)]
        turn = rotation_between(pose, desired)
        values = (
            sqrt(sum(value * value for value in shift)),
            sqrt(sum(value * value for value in turn)),
            abs(q[2] - state.q_d[2]),
        )
        name = "max_path_pose_deviation_violation"
        return [
            ArmError(name, where, value, bound, unit)
            for where, value, bound, unit in zip(
                ("translation", "rotation", "elbow"),
                values,
                self._thresholds.path_deviation,
                ("m", "rad", "rad"),
                strict=True,
            )
            if value > bound
        ]


def _excess(error: ArmError) -> float:
    return abs(error.value - error.limit)


def _tolerance(error: ArmError) -> float:
    return _WORSE if error.unit in {"rad", "m"} else _WORSE_SHARE * error.limit
