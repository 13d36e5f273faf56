"""Watches what is measured and keeps the errors, as the arm itself would.

Source: Franka Control Interface documentation, Errors; libfranka@0.9.2
include/franka/errors.h; differs: thresholds that Franka does not publish are in
`SupervisorLimits`.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, sqrt

from station.core.interfaces.franka_errors import ERROR_INDEX, ArmError
from station.core.interfaces.franka_model import Frame
from station.core.interfaces.franka_robot_state import RobotState
from station.core.interfaces.franka_services import ArmRecord
from station.core.rigid_motion import times
from station.hw.franka.arm_limits import ArmLimits
from station.hw.franka.franka_kinematics import zero_jacobian

LOG_LENGTH = 50
"""Cycles that are kept from before an error."""
# Farther than any end effector is from any joint axis [m].
_REACH = 1.3


@dataclass(frozen=True, slots=True)
class SupervisorLimits:
    """Thresholds of measured quantities that Franka does not publish.

    Attributes:
        position_tolerance: Beyond a position limit [rad].
        velocity_factor: Of the velocity limits, joints and end effector.
        debounce: Cycles that a measured value must be out of its range, >= 1.
        power: Sum over the joints of |tau_J dq| [W].
    """

    position_tolerance: float = 0.01
    velocity_factor: float = 1.02
    debounce: int = 3
    power: float = inf


class ArmSupervisor:
    """Finds errors in the measured state, and keeps those of the arm.

    Control thread only.

    Args:
        state: The arm's state; `current_errors` and `last_motion_errors` are written.
        limits: The arm's limits.
        thresholds: The rest of the thresholds.

    Attributes:
        errors: What the present errors came from; after a recovery empty.
        last_motion_errors: What ended the last motion.
        log: The last cycles before the last error.
    """

    def __init__(
        self, state: RobotState, limits: ArmLimits, thresholds: SupervisorLimits
    ) -> None:
        self._state = state
        self._limits = limits
        self._thresholds = thresholds
        slack = thresholds.position_tolerance
        self._lower = [value - slack for value in limits.lower]
        self._upper = [value + slack for value in limits.upper]
        self._velocity = [v * thresholds.velocity_factor for v in limits.velocity]
        self._speed = limits.translation.velocity * thresholds.velocity_factor
        self._bad_cycles = 0
        self._recent: deque[ArmRecord] = deque(maxlen=LOG_LENGTH)
        self.errors: list[ArmError] = []
        self.last_motion_errors: list[ArmError] = []
        self.log: list[ArmRecord] = []

    def record(self, command: Sequence[float]) -> None:
        """Keep this cycle for the log.

        Args:
            command: What the client sent last.
        """
        state = self._state
        self._recent.append(
            ArmRecord(
                state.time,
                tuple(state.q),
                tuple(state.dq),
                tuple(state.tau_J),
                tuple(state.q_d),
                tuple(state.tau_J_d),
                tuple(command),
            )
        )

    def measured_errors(self, q: Sequence[float]) -> list[ArmError]:
        """Return what of the measured state is out of its range for too long.

        Args:
            q: Positions [rad], shape (7,).
        """
        state = self._state
        total = power = 0.0
        is_good = True
        for position, velocity, tau, low, high, fastest, largest in zip(
            q,
            state.dtheta,
            state.tau_J,
            self._lower,
            self._upper,
            self._velocity,
            self._limits.torque,
            strict=True,
        ):
            if not (
                low <= position <= high
                and -fastest <= velocity <= fastest
                and -largest <= tau <= largest
            ):
                is_good = False
            total += abs(velocity)
            power += abs(velocity * tau)
        if is_good and total * _REACH < self._speed and power < self._thresholds.power:
            self._bad_cycles = 0
            return []
        found = self._find(q, power)
        self._bad_cycles = self._bad_cycles + 1 if found else 0
        return found if self._bad_cycles >= self._thresholds.debounce else []

    def set_errors(self, errors: Sequence[ArmError], cycle: int) -> None:
        """Raise errors; those that are there already stay as they are.

        Args:
            errors: The errors.
            cycle: Number of the arm's cycle.
        """
        state = self._state
        if not self.errors:
            self.log = list(self._recent)
        known = {(error.name, error.where) for error in self.errors}
        for error in errors:
            if (error.name, error.where) not in known:
                self.errors.append(replace(error, cycle=cycle))
            state.current_errors[ERROR_INDEX[error.name]] = True

    def begin_motion(self) -> None:
        """Forget what ended the motion before."""
        self.clear()
        self.end_motion()

    def end_motion(self) -> None:
        """Note that the present errors, if any, have ended a motion."""
        self.last_motion_errors = list(self.errors)
        self._state.last_motion_errors[:] = self._state.current_errors

    def clear(self) -> None:
        """Forget the present errors, not those of the last motion."""
        self.errors = []
        self._state.current_errors[:] = [False] * len(self._state.current_errors)
        self._bad_cycles = 0
        self._recent.clear()

    def _find(self, q: Sequence[float], power: float) -> list[ArmError]:
        state, limits = self._state, self._limits
        found: list[ArmError] = []
        for i, position in enumerate(q):
            joint = f"joint{i + 1}"
            velocity, tau = state.dtheta[i], state.tau_J[i]
            if not self._lower[i] <= position <= self._upper[i]:
                bound = limits.upper[i]
                if position < self._lower[i]:
                    bound = limits.lower[i]
                name = "joint_position_limits_violation"
                found.append(ArmError(name, joint, position, bound, "rad"))
            if abs(velocity) > self._velocity[i]:
                bound = limits.velocity[i]
                name = "joint_velocity_violation"
                found.append(ArmError(name, joint, velocity, bound, "rad/s"))
            if abs(tau) > limits.torque[i]:
                bound = limits.torque[i]
                found.append(ArmError("tau_j_range_violation", joint, tau, bound, "Nm"))
        twist = times(zero_jacobian(Frame.END_EFFECTOR, q, state.F_T_EE), state.dtheta)
        speed = sqrt(sum(value * value for value in twist[:3]))
        if speed > self._speed:
            bound = limits.translation.velocity
            name = "cartesian_velocity_violation"
            found.append(ArmError(name, "end effector", speed, bound, "m/s"))
        if power > self._thresholds.power:
            bound = self._thresholds.power
            found.append(ArmError("power_limit_violation", "", power, bound, "W"))
        return found
