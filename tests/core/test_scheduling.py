"""The interpreter's real-time settings come and go as a whole."""

import gc
import os
import sys

import pytest

from station.core.scheduling import (
    GC_THRESHOLDS,
    SWITCH_INTERVAL,
    realtime_interpreter,
    request_realtime_priority,
)


def test_settings_hold_inside_and_are_restored_after():
    before = (sys.getswitchinterval(), gc.get_threshold())
    with realtime_interpreter():
        assert sys.getswitchinterval() == pytest.approx(SWITCH_INTERVAL)
        assert gc.get_threshold() == GC_THRESHOLDS
        assert gc.get_freeze_count() > 0
    assert (sys.getswitchinterval(), gc.get_threshold()) == before


def test_a_refused_priority_is_said_in_words(monkeypatch):
    def refuse(*_: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    granted = request_realtime_priority()
    assert granted == ("SCHED_OTHER (SCHED_FIFO was refused: Operation not permitted)")
