"""The interpreter's real-time settings come and go as a whole."""

import gc
import os
import sys

import pytest

from station.core.loop.scheduling import (
    GC_THRESHOLDS,
    NICENESS,
    SWITCH_INTERVAL,
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


def test_threads_started_inside_are_favoured_where_that_is_permitted(monkeypatch):
    asked = []
    niceness = os.getpriority(os.PRIO_PROCESS, 0)
    monkeypatch.setattr(os, "setpriority", lambda *call: asked.append(call))
    monkeypatch.setattr(
        os, "getpriority", lambda *_: asked[-1][2] if asked else niceness
    )
    with realtime_interpreter():
        assert asked == [(os.PRIO_PROCESS, 0, NICENESS)]
    assert asked[1:] == [(os.PRIO_PROCESS, 0, niceness)]


def test_a_refused_niceness_is_no_obstacle(monkeypatch):
    def refuse(_which: int, _who: int, niceness: int) -> None:
        if niceness < 0:
            raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "setpriority", refuse)
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
