"""The guard against leaked threads sees what it should."""

import threading

import pytest

from tests.thread_guard import leaked_threads


@pytest.mark.parametrize("daemon", [False, True])
def test_running_thread_is_reported(daemon):
    before = threading.enumerate()
    release = threading.Event()
    thread = threading.Thread(target=release.wait, daemon=daemon)
    thread.start()

    leaked = leaked_threads(before, grace=0.0)

    release.set()
    thread.join()
    assert leaked == [thread]


def test_thread_that_is_about_to_end_is_waited_for():
    before = threading.enumerate()
    release = threading.Event()
    thread = threading.Thread(target=release.wait)
    thread.start()
    release.set()

    assert leaked_threads(before) == []


def test_thread_that_ran_before_is_nobodys_leak():
    release = threading.Event()
    thread = threading.Thread(target=release.wait)
    thread.start()

    leaked = leaked_threads(threading.enumerate(), grace=0.0)

    release.set()
    thread.join()
    assert leaked == []
