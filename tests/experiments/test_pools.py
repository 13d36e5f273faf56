"""Executors of this machine."""

import os
import signal
from concurrent.futures import Executor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace

import pytest

from station.experiments import pools
from station.experiments.pools import (
    NICENESS,
    InThisProcess,
    compare,
    identity,
    losses,
    make_pool,
    refusals,
    run_trials,
    worker_count,
)
from station.trials.errors import ExperimentError, WorkerMismatchError
from tests.waiting import wait_until


def test_this_process():
    with make_pool(0) as pool:
        assert isinstance(pool, InThisProcess)
        assert worker_count(pool) == 1
        assert pool.submit(os.getpid).result() == os.getpid()
        assert isinstance(pool.submit(int, "x").exception(), ValueError)


@pytest.mark.slow
def test_worker_that_keeps_worlds_ends_without_a_word(capfd):
    keep = """
import ruckig, threading
kept, never = ruckig.Ruckig(1, 0.001), threading.Event()
threading.Thread(target=lambda _: never.wait(), args=(kept,), daemon=True).start()
"""
    with make_pool(1) as pool:
        pool.submit(exec, keep, {}).result()
    assert capfd.readouterr().err == ""


def test_negative_number_is_refused():
    with pytest.raises(ExperimentError, match="cannot be -1 workers"):
        make_pool(-1)


def test_executor_that_says_nothing():
    assert worker_count(Executor()) == 1
    assert losses(Executor()) == (BrokenProcessPool,)
    assert refusals(Executor()) == {}


@pytest.mark.slow
def test_process_that_was_killed_is_replaced():
    with make_pool(1) as pool:
        assert worker_count(pool) == 1
        first = pool.submit(os.getpid).result()
        # Ends the process as the system does when memory is short.
        killed = pool.submit(os.kill, first, signal.SIGKILL)
        assert isinstance(killed.exception(), BrokenProcessPool)

        second = pool.submit(os.getpid).result()

        assert second not in {first, os.getpid()}
        assert pool.submit(os.nice, 0).result() == max(NICENESS, os.nice(0))


@pytest.mark.slow
def test_ctrl_c_does_not_reach_a_process_that_still_begins():
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [])
    with make_pool(1) as pool:
        blocked = pool.submit(signal.pthread_sigmask, signal.SIG_BLOCK, []).result()

    assert signal.SIGINT in blocked
    assert signal.pthread_sigmask(signal.SIG_BLOCK, []) == before


@pytest.mark.slow
def test_processes_are_ended_while_they_work():
    with make_pool(1) as pool:
        assert pool.submit(os.getpid).result() != os.getpid()
        endless = pool.submit(signal.pause)
        assert wait_until(endless.running)
        pool.abandon()

        assert isinstance(endless.exception(20.0), BrokenProcessPool)


@pytest.mark.parametrize("what", ["station", "mujoco", "setup"])
def test_each_difference_is_named_with_both_values(step, what):
    own = identity(step.setup.text)
    other = replace(own, **{what: "9.9.9"})

    compare(own, own, "w1")
    with pytest.raises(WorkerMismatchError, match=f"Worker w1 has {what} 9.9.9; the"):
        compare(own, other, "w1")


def test_a_worker_with_another_mujoco_runs_no_trial(step, monkeypatch):
    expected = identity(step.setup.text)
    monkeypatch.setattr(pools.mujoco, "mj_versionString", lambda: "2.3.7")
    monkeypatch.setattr(pools, "_checked", set())

    with pytest.raises(WorkerMismatchError, match=r"has mujoco 2\.3\.7; the"):
        run_trials(step.setup.text, [step.to_json()], expected)
    assert pools._checked == set()
