"""A function in a thread of its own, beside a cycle that never waits for it.

Asynchronous controllers and asynchronous hardware are both built on it.

Source: ros2_control@6.x realtime_tools/async_function_handler.hpp; differs: a result
counts after a declared number of cycles, and no thread waits for a call that is under
way.
"""

import os
import threading
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

from station.core.declared_parameter import (
    declare_boolean,
    declare_number,
    declare_string,
)
from station.core.errors import CONTAINED
from station.core.numerics.durations import DurationRing
from station.core.parameters import Parameters
from station.core.ports.command_ticket import update_of_thread
from station.core.scheduling import ROUND_ROBIN_PRIORITY
from station.memory.wall_time import wall_time
from station.reports import AsyncStatistics

IS_ASYNC = declare_boolean(
    "is_async", "update it in a thread of its own, beside the loop", default=False
)
POLICY = declare_string(
    "async_parameters/scheduling_policy",
    "when the result of an asynchronous update counts",
    "synchronized",
    choices=("synchronized", "detached"),
)
CYCLES = declare_number(
    "async_parameters/cycles",
    "after how many cycles the result of an asynchronous update counts",
    1.0,
    minimum=1.0,
)
TIME_LIMIT = declare_number(
    "async_parameters/time_limit",
    "an asynchronous update that takes longer is a fault",
    1.0,
    "s",
    minimum=0.0,
    excludes_minimum=True,
)
PROCESS = declare_boolean(
    "async_parameters/process",
    "update it in a process, and a Python interpreter, of its own",
    default=False,
)
_WITHOUT_EFFECT = (
    "thread_priority",
    "cpu_affinity",
    "execution_rate",
    "wait_until_initial_trigger",
    "print_warnings",
)
"""Names that files of ROS 2 may have in `async_parameters` and that have no effect;
`update_rate` sets the rate."""


@dataclass(frozen=True, slots=True)
class AsyncParams:
    """The parameters of an asynchronous controller or robot.

    Attributes:
        is_detached: Whether a result counts as soon as it exists.
        cycles: Number of cycles after which the result of a call counts, >= 1.
        time_limit: Longest time that a call may take [s station time], > 0.
        has_process: Whether calls are carried out in a process of their own.
    """

    is_detached: bool
    cycles: int
    time_limit: float
    has_process: bool = False

    @classmethod
    def read(cls, params: Parameters, reads: set[str]) -> "AsyncParams | None":
        """Return the parameters of a namespace; None if it is not asynchronous.

        Args:
            params: The namespace.
            reads: Receives the full names of parameters that have no effect here.

        Raises:
            ParameterError: A value is impossible.
        """
        # Read all of them, so that impossible values are refused in any case.
        policy, cycles = POLICY.read_str(params), CYCLES.read_float(params)
        time_limit, has_process = (
            TIME_LIMIT.read_float(params),
            PROCESS.read_bool(params),
        )
        if cycles != int(cycles):
            CYCLES.refuse(params, cycles, "a whole number >= 1")
        if not IS_ASYNC.read_bool(params):
            return None
        reads |= {
            params.resolve(f"async_parameters/{each}") for each in _WITHOUT_EFFECT
        }
        return cls(policy == "detached", int(cycles), time_limit, has_process)


class AsyncFunction:
    """Carries out calls of one function, one at a time, in a thread of its own.

    All methods but `statistics` are for the control thread.

    Args:
        name: Name of the function, for the name of the thread.
        function: Takes the station time of the cycle in which a call begins [s] and the
            time since the last call began [s].
        params: Policy, cycles and time limit of the calls.

    Attributes:
        every: Cycles from the beginning of a call to that of the next one, >= 1.
        is_stepped: Returns whether no thread runs the loop. A call is then carried out
            at once, and counts after the declared cycles.
        present_cycle: Returns the number of the present cycle.
        params: As given.
    """

    def __init__(
        self, name: str, function: Callable[[float, float], None], params: AsyncParams
    ) -> None:
        self.every = 1
        self.is_stepped: Callable[[], bool] = lambda: True
        self.present_cycle: Callable[[], int] = lambda: 0
        self.params = params
        self._name = name
        self._function = function
        # The lock that wakes the thread, from the first call to `end_thread`.
        self._go: threading.Lock | None = None
        self._run_number = 0
        # The call under way: its time and period, and the function to call after it.
        self._job = (0.0, 0.0)
        self._begun_in = 0
        self._is_busy = self._is_ending = False
        self._owed: deque[Callable[[], None]] = deque()
        self._error: BaseException | None = None
        self._in_flight = False
        self._waited = self._countdown = 0
        self._elapsed = 0.0
        self._age = self._missed = 0
        self._durations, self._periods = DurationRing(1024), DurationRing(1024)

    def statistics(self) -> AsyncStatistics:
        """Return periods and durations of the calls. Any thread."""
        return AsyncStatistics(
            "detached" if self.params.is_detached else "synchronized",
            self._age,
            self._missed,
            self._durations.percentiles(),
            self._periods.percentiles(),
        )

    def is_idle(self) -> bool:
        """Return whether neither a call nor the function after it is under way."""
        return not (self._is_busy or self._is_ending or self._owed)

    def is_overdue(self, time: float) -> bool:
        """Return whether the call under way takes longer than the time limit.

        Args:
            time: Station time [s].
        """
        return (
            self._in_flight
            and self._is_busy
            and time - self._job[0] > self.params.time_limit
        )

    def end_thread(self) -> None:
        """End the thread after the call under way; the next call makes a new one.

        Called in the control thread, or while no thread runs the loop.
        """
        self._run_number += 1
        go, self._go = self._go, None
        if go is not None and not self._is_busy:
            go.release()

    def begin_anew(self) -> None:
        """Forget results that do not count yet; the next call is due at once."""
        self._in_flight, self._error = False, None
        self._waited = self._countdown = self._age = 0
        self._elapsed = 0.0

    def end(self, last: Callable[[], None], *, in_thread: bool = False) -> bool:
        """Discard the call under way, end the thread, and call a function last.

        Args:
            last: Called in the thread, after the call under way.
            in_thread: Whether to call it in the thread in any case, because it may take
                long.

        Returns:
            Whether nothing is under way, so that the caller has to call `last` itself.
        """
        self._in_flight = False
        self._owed.append(last)
        if in_thread and self._go is None and not self._is_busy:
            self._start_thread()
        self.end_thread()
        if in_thread or self._is_busy:
            return False  # its thread calls it
        try:
            self._owed.pop()
        except IndexError:
            return False  # its thread has just ended, and calls it
        return True

    def take_result(self, period: float) -> bool:
        """Count a cycle; return whether the result of a call counts from now on.

        Args:
            period: Time since the last cycle [s].

        Raises:
            BaseException: Whatever the function raised.
        """
        self._age += 1
        self._elapsed += period
        self._countdown -= 1
        if not self._in_flight:
            return False
        self._waited += 1
        is_early = self.params.is_detached and not self.is_stepped()
        if self._is_busy or (self._waited < self.params.cycles and not is_early):
            return False
        self._in_flight = False
        error, self._error = self._error, None
        if error is not None:
            raise error
        self._age = self._waited
        return True

    def begin_call(self, time: float, prepare: Callable[[], None]) -> None:
        """Begin a call, if one is due and the last one has ended.

        Args:
            time: Station time [s].
            prepare: Called before the call, in the control thread.
        """
        if self._countdown > 0:
            return
        if self._in_flight:
            if not self.params.is_detached:
                # The call under way is not finished, so this one is skipped.
                self._missed += 1
                self._countdown = self.every
            return
        self._countdown = self.every
        prepare()
        self._job, self._elapsed = (time, self._elapsed), 0.0
        self._begun_in = self.present_cycle()
        self._periods.add(self._job[1])
        self._in_flight, self._waited, self._is_busy = True, 0, True
        if self.is_stepped():
            self._call()
            return
        (self._go or self._start_thread()).release()

    def _start_thread(self) -> threading.Lock:
        """Start the thread; return the lock whose release wakes it."""
        go = self._go = threading.Lock()
        go.acquire()
        threading.Thread(
            target=self._run,
            args=(go, self._run_number),
            name=f"async {self._name}",
            daemon=True,
        ).start()
        return go

    def _run(self, go: threading.Lock, run_number: int) -> None:
        _step_behind_the_control_thread()
        while run_number == self._run_number:
            go.acquire()
            # The thread is also woken to end.
            if self._is_busy:
                update_of_thread.cycle = self._begun_in
                self._call()
        if self._owed:
            self._call_what_is_owed()

    def _call(self) -> None:
        begin = wall_time()
        try:
            self._function(*self._job)
        except CONTAINED as error:  # raised again in the control thread
            self._error = error
        except KeyboardInterrupt as interrupt:
            # Only the main thread gets it from Python; here the function has raised it.
            # It would end this thread, and the caller would wait for it without a word.
            self._error = RuntimeError("KeyboardInterrupt")
            self._error.__cause__ = interrupt
        self._durations.add(wall_time() - begin)
        # In this order, so that a function added meanwhile finds no call under way.
        self._is_ending = True
        self._is_busy = False
        self._call_what_is_owed()

    def _call_what_is_owed(self) -> None:
        self._is_ending = True
        if self._owed:
            # The caller has stopped, so its results and faults do not matter.
            with suppress(*CONTAINED, IndexError):
                self._owed.pop()()
        self._is_ending = False


def _step_behind_the_control_thread() -> None:
    """Take the lowest real-time priority, as the station's other threads do.

    A thread inherits the priority of the control thread, which starts it, and threads
    of equal priority do not preempt each other. An ordinary priority would be too low:
    a thread that holds the interpreter must not wait for a processor.
    """
    # Some systems lack this call, and some users may not use it.
    is_first = getattr(os, "SCHED_FIFO", None)
    if is_first is not None and os.sched_getscheduler(0) == is_first:
        with suppress(PermissionError):
            least = os.sched_param(ROUND_ROBIN_PRIORITY)
            os.sched_setscheduler(0, os.SCHED_RR, least)
