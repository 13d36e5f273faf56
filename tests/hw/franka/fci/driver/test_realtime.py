"""Whether a thread may command a real arm, as libfranka decides it."""

import os

from station.hw.franka.fci.driver.fci_arm import realtime_problem


def kernel(tmp_path, text):
    path = tmp_path / "realtime"
    path.write_text(text)
    return path


def test_thread_without_sched_fifo_is_told(monkeypatch, tmp_path):
    monkeypatch.setattr(os, "sched_getscheduler", lambda _thread: os.SCHED_OTHER)
    problem = realtime_problem(1, kernel(tmp_path, "1\n"))
    assert problem is not None
    assert "SCHED_FIFO" in problem


def test_kernel_without_realtime_is_told_in_libfrankas_words(monkeypatch, tmp_path):
    monkeypatch.setattr(os, "sched_getscheduler", lambda _thread: os.SCHED_FIFO)
    words = "libfranka: Running kernel does not have realtime capabilities"
    for path in (tmp_path / "missing", kernel(tmp_path, "0\n")):
        problem = realtime_problem(1, path)
        assert problem.startswith(words)
        assert "realtime_config: ignore" in problem


def test_realtime_thread_on_a_realtime_kernel_may(monkeypatch, tmp_path):
    monkeypatch.setattr(os, "sched_getscheduler", lambda _thread: os.SCHED_FIFO)
    assert realtime_problem(1, kernel(tmp_path, "1\n")) is None


def test_thread_that_is_gone_is_told():
    words = "libfranka: unable to set realtime scheduling; "
    assert realtime_problem(2**22 + 1).startswith(words)
