"""A switch on its way from the caller to the control thread and back."""

import threading
from enum import Enum

from station.core.control.loaded_controller import LoadedController
from station.core.control.switching import (
    SwitchOutcome,
    SwitchPlan,
    SwitchRequest,
    SwitchResult,
)
from station.core.errors import StationError, SwitchRefusedError

__all__ = ["PendingSwitch", "SwitchOutcome", "SwitchProgress", "refused"]


class SwitchProgress(Enum):
    """The phases of a pending switch."""

    POSTED = "posted"
    CLAIMED = "claimed"
    RUNNING = "running"
    ROLLING_BACK = "rolling_back"
    FINISHED = "finished"


class PendingSwitch:
    """One planned switch and its progress.

    It belongs to the thread that acquires `claim`: the control thread to begin it, or
    the caller to withdraw it. So a switch is carried out for hardware and controllers
    alike, or not at all (CM-74). No thread waits for `claim`; only the caller waits for
    `done`, which the control thread releases.

    Args:
        request: The request of the caller.
        plan: The plan that follows from the request.
        start: Controllers to start, in the order of the request.
        stop: Controllers to stop, in the order of the request.
        time: Station time at the request [s]; None when no cycle has run yet.

    Attributes:
        failed: By name, why a controller is not as requested.
        given_up: Names that failed by themselves and are not tried again.
        not_restored: By name, why a controller that ran before does not run again.
        jump: By resource, the jump of its first command.
        expired: Whether to give up waiting for the hardware; set by the caller.
        error: The switch is refused with this error; None if it is not refused.
        outcome: How it ended.
        cycle: Cycle in which it was finished.
    """

    def __init__(
        self,
        request: SwitchRequest,
        plan: SwitchPlan,
        start: list[LoadedController],
        stop: list[LoadedController],
        time: float | None,
    ) -> None:
        self.request = request
        self.plan = plan
        self.start = start
        self.stop = stop
        self.time = time
        self.progress = SwitchProgress.POSTED
        self.failed: dict[str, str] = {}
        self.given_up: set[str] = set()
        self.not_restored: dict[str, str] = {}
        self.jump: dict[str, float] = {}
        self.expired = False
        self.error: StationError | None = None
        self.outcome = SwitchOutcome.COMMITTED
        self.cycle = 0
        self.claim = threading.Lock()
        self.done = threading.Lock()
        self.done.acquire()

    def finish(self, cycle: int) -> None:
        """Mark the switch as finished and wake its caller. Control thread."""
        self.cycle = cycle
        # Set before the lock is released, because the caller then reads everything.
        self.progress = SwitchProgress.FINISHED
        self.done.release()

    def note_start(self, name: str, problem: str | None) -> None:
        """Note that `name` was started, or the `problem` that prevented the start."""
        if problem is not None:
            self.failed[name] = problem
            self.given_up.add(name)
        else:
            self.failed.pop(name, None)

    def is_late(self, time: float) -> bool:
        """Return whether the hardware has taken too long at station time `time` [s].

        True after the timeout plus a margin for rounding (CM-67), and once `expired`.
        """
        if self.expired:
            return True
        timeout = self.request.timeout
        since = self.time
        # The margin is rounding: station time is a sum of periods.
        return timeout > 0.0 and since is not None and time - since > timeout + 1e-9

    def lateness(self, time: float) -> str | None:
        """Return the reason to give up the switch at station time `time` [s]."""
        if not self.is_late(time):
            return None
        # In a pause no station time passes, so waiting longer would not help.
        if time == self.time:
            return "the hardware cannot get ready while station time stands still"
        return "the hardware was not ready in time"

    def result(self) -> SwitchResult:
        """Return the result of the finished switch.

        Raises:
            StationError: The control thread refused the switch.
        """
        if self.error is not None:
            raise self._with_outcome(self.error)
        plan = self.plan
        committed = self.outcome is SwitchOutcome.COMMITTED
        started = [i.name for i in plan.start if i.name not in self.failed]
        stopped = [info.name for info in plan.stop]
        # What was stopped runs again.
        if self.outcome is SwitchOutcome.ROLLED_BACK:
            stopped = []
        return SwitchResult(
            ok=not self.failed and committed,
            started=tuple(started) if committed else (),
            stopped=tuple(stopped),
            cycle=self.cycle,
            plan=plan,
            outcome=self.outcome,
            failed={**self.failed, **self.not_restored},
            jump=dict(self.jump),
        )

    def _with_outcome(self, error: StationError) -> StationError:
        """Return the refusal, with the controllers that do not run again added."""
        for name, problem in self.not_restored.items():
            error.message += (
                f" '{name}' could not be started again: {problem.rstrip('.')}."
            )
        if self.not_restored:
            error.remedy = (
                "Nobody commands the resources of this switch now. Look at the faults "
                "of the controllers, correct them and switch again."
            )
        return error


def refused(name: str, reason: str, pending: PendingSwitch) -> SwitchRefusedError:
    """Return the error for a strict switch in which `name` did not start.

    Args:
        name: The controller.
        reason: Why it did not start.
        pending: The switch; its `jump` goes into the details.
    """
    return SwitchRefusedError(
        f"Controller '{name}' did not start: {reason.rstrip('.')}.",
        remedy="What ran before runs again. Correct the controller and repeat.",
        details={"controller": name, "jump": dict(pending.jump)},
    )
