"""The interpreter's real-time settings come and go as a whole."""

import gc
import os
import sys

import pytest

from station.core.scheduling import (
    GC_THRESHOLDS,
    NICENESS,
    ROUND_ROBIN_PRIORITY,
    SWITCH_INTERVAL,
    ordinary_priority,
    realtime_interpreter,
    request_realtime_priority,
)


def test_settings_hold_inside_and_are_restored_after():
    before = _settings()
    with realtime_interpreter():
        assert sys.getswitchinterval() == pytest.approx(SWITCH_INTERVAL)
        assert gc.get_threshold() == GC_THRESHOLDS
        assert gc.get_freeze_count() > 0
    assert _settings() == before


def test_threads_started_inside_are_favoured_and_processes_can_be_ordinary(scheduled):
    with realtime_interpreter():
        assert scheduled.now == (os.SCHED_RR, ROUND_ROBIN_PRIORITY, NICENESS)
        with ordinary_priority():
            assert scheduled.now == (os.SCHED_OTHER, 0, 0)
        assert scheduled.now == (os.SCHED_RR, ROUND_ROBIN_PRIORITY, NICENESS)
    assert scheduled.now == (os.SCHED_OTHER, 0, 3)


def test_an_ordinary_process_stays_as_nice_as_its_station(scheduled):
    with ordinary_priority():
        assert scheduled.now == (os.SCHED_OTHER, 0, 3)


class Scheduled:
    """Stands for the system, which grants a thread everything; starts with nice 3."""

    def __init__(self) -> None:
        self.now = (os.SCHED_OTHER, 0, 3)

    def setpriority(self, _which: int, _who: int, niceness: int) -> None:
        self.now = (*self.now[:2], niceness)

    def getpriority(self, _which: int, _who: int) -> int:
        return self.now[2]

    def sched_setscheduler(self, _pid: int, policy: int, param: os.sched_param) -> None:
        self.now = (policy, param.sched_priority, self.now[2])

    def sched_getscheduler(self, _pid: int) -> int:
        return self.now[0]

    def sched_getparam(self, _pid: int) -> os.sched_param:
        return os.sched_param(self.now[1])


@pytest.fixture
def scheduled(monkeypatch):
    system = Scheduled()
    for name in (
        "setpriority",
        "getpriority",
        "sched_setscheduler",
        "sched_getscheduler",
        "sched_getparam",
    ):
        monkeypatch.setattr(os, name, getattr(system, name))
    return system


def test_a_refused_favour_is_no_obstacle(monkeypatch):
    def refuse(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "setpriority", refuse)
    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    with realtime_interpreter():
        assert sys.getswitchinterval() == pytest.approx(SWITCH_INTERVAL)


def _settings() -> tuple[object, ...]:
    niceness = os.getpriority(os.PRIO_PROCESS, 0)
    return sys.getswitchinterval(), gc.get_threshold(), niceness


def test_a_refused_priority_is_said_in_words(monkeypatch):
    def refuse(*_: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    granted = request_realtime_priority()
    assert granted == ("SCHED_OTHER (SCHED_FIFO was refused: Operation not permitted)")
