"""Find errors in the measured state of an arm and store them, as a real arm does.

Source: Franka Control Interface documentation, Errors; libfranka@0.9.2
include/franka/errors.h; differs: thresholds that Franka does not publish are in
`SupervisorLimits`.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from station.core.franka.franka_errors import ERROR_INDEX, ArmError
from station.core.franka.franka_model import Frame
from station.core.franka.franka_robot_state import RobotState
from station.hw.franka.arm.arm_limits import SupervisorLimits
from station.hw.franka.arm.franka_kinematics import zero_jacobian
from station.hw.franka.simulated.arm_step import CycleLog
from station.hw.franka.simulated.joint_watch import JointWatch
from station.reports import ArmRecord

# Change for the worse after a recovery that makes a value an error again [rad or m]; in
# other units a share of the limit.
_WORSE = 0.005
_WORSE_SHARE = 0.1
_ELBOW_JOINT = 2


class ArmSupervisor:
    """Finds errors in the measured state, and stores the errors of the arm.

    A value that is still out of its range when the arm recovers, such as a joint beyond
    its limit, becomes an error again only if it moves further out. So the arm can be
    moved back.

    Control thread only.

    Args:
        state: The arm's state; this class writes `current_errors` and
            `last_motion_errors`.
        thresholds: Thresholds that Franka does not publish.
        watch: Compares the readings with their limits in every cycle.
        cycle_log: The last cycles.

    Attributes:
        errors: The present errors with their causes; empty after a recovery.
        last_motion_errors: The errors that ended the last motion.
        log: The last cycles before the last error.
    """

    def __init__(
        self,
        state: RobotState,
        thresholds: SupervisorLimits,
        watch: JointWatch,
        cycle_log: CycleLog,
    ) -> None:
        self._state = state
        self._thresholds = thresholds
        self._watch = watch
        self._cycle_log = cycle_log
        self._bad_cycles = 0
        self._known: dict[tuple[str, str], float] = {}
        self.errors: list[ArmError] = []
        self.last_motion_errors: list[ArmError] = []
        self.log: list[ArmRecord] = []

    def singular_start(self) -> str | None:
        """Return the reason why no Cartesian motion can start at the present pose.

        None if one can.
        """
        state, least = self._state, self._thresholds.singular_start
        frames = state.q_d, state.F_T_EE, state.EE_T_K
        jacobian = np.reshape(zero_jacobian(Frame.END_EFFECTOR, *frames), (-1, 6))
        # Six joints follow the pose; the elbow gives the position of joint 3.
        others = np.delete(jacobian, _ELBOW_JOINT, 0)
        value = float(np.linalg.svd(others, compute_uv=False)[-1])
        if value >= least:
            return None
        return (
            f"the pose is singular (the least singular value of the Jacobian is "
            f"{value:.2g}, below {least:g}); move the arm by its joints first"
        )

    def examine(
        self, *, is_quiet: bool, is_following: bool, is_recovering: bool
    ) -> list[ArmError]:
        """Find errors in a cycle in which the watch may have found violations.

        Args:
            is_quiet: Whether the watch has found no violation.
            is_following: Whether the arm follows a desired motion.
            is_recovering: Whether the arm only brakes and comes to rest. Values out of
                range are then accepted, because a lasting push would otherwise undo
                every recovery.

        Returns:
            Errors of measured values that were out of range for too long.
        """
        # After the last violation one more cycle is examined, which resets the count.
        self._watch.is_alert = not is_quiet
        if is_quiet:
            self._bad_cycles = 0
            self._known = {}
            return []
        # Compared again, because noise was added to the readings after the watch.
        self._watch.check_readings(is_following, has_moved=False)
        if is_recovering:
            self._accept()
            return []
        # One reading beyond a limit may be noise; `debounce` of them in a row are not.
        found = self._new(self._watch.violations.errors())
        self._bad_cycles = self._bad_cycles + 1 if found else 0
        return found if self._bad_cycles >= self._thresholds.debounce else []

    def set_errors(self, errors: Sequence[ArmError], cycle: int) -> None:
        """Raise errors; an error that is already present does not change.

        Args:
            errors: The errors.
            cycle: Number of the arm's cycle.
        """
        state = self._state
        # The cycles before the first error explain it; later ones only show braking.
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
        """Forget the errors that ended the last motion."""
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
        self._watch.room = 0.0
        self._watch.check_readings(is_following=False, has_moved=False)
        self._accept()
        self._watch.is_alert = True

    def _accept(self) -> None:
        """Store the values that are out of range now as known."""
        found = self._watch.violations.errors()
        self._known = {(e.name, e.where): _excess(e) for e in found}

    def expect_new_pose(self) -> None:
        """Compute all distances in the next cycle: the arm was set to a new pose."""
        self._watch.room = 0.0
        self._known = {}

    def _new(self, found: list[ArmError]) -> list[ArmError]:
        """Return the errors that are new or worse since the last recovery."""
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


def _excess(error: ArmError) -> float:
    return abs(error.value - error.limit)


def _tolerance(error: ArmError) -> float:
    return _WORSE if error.unit in {"rad", "m"} else _WORSE_SHARE * error.limit
