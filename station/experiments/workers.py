"""Run trials in a worker process, which keeps its worlds between trials.

Arguments are plain text, so that any executor can send them to a worker.
"""

import atexit
import os
import platform
import signal
import threading
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass, fields
from importlib.metadata import version
from multiprocessing import parent_process
from multiprocessing.process import BaseProcess

import mujoco

from station.compiled import source_digest
from station.experiments.trial_world import TrialWorld
from station.trials.errors import WorkerMismatchError
from station.trials.trial import Setup, Trial, TrialResult

_WORLDS = 2
"""Number of worlds that a worker keeps."""
WORKER = f"{platform.node()}:{os.getpid()}"
"""Name of this process: host and process number."""
_one_at_a_time = threading.Lock()
"""Lock, because a worker of a cluster may have several threads, but a world allows one.
"""
_checked: set[str] = set()
"""Setups for which this process was found equal to the caller."""
_worlds: "OrderedDict[str, TrialWorld]" = OrderedDict()


@dataclass(frozen=True, slots=True)
class Identity:
    """Versions and digests that must agree on all machines of an experiment.

    Attributes:
        station: Version of the station, and a digest of its arithmetic.
        mujoco: Version of MuJoCo.
        setup: Digest of the setup as the worker has read it, and of the robot, which
            comes from files on the worker's machine.
    """

    station: str
    mujoco: str
    setup: str


def identity(setup_text: str) -> Identity:
    """Return the versions and digests of this process for a setup.

    Raises:
        StationError: The setup cannot be used here.
    """
    world = kept_world(Setup(setup_text))
    return Identity(
        f"{version('control-station')}+{source_digest()[:12]}",
        mujoco.mj_versionString(),
        f"{world.setup.digest}+{world.robot_digest}",
    )


def run_trials(
    setup_text: str, trial_texts: Sequence[str], expected: Identity | None = None
) -> list[TrialResult]:
    """Run trials one after the other; the result of a failed trial has its error.

    Args:
        setup_text: Text of the setup.
        trial_texts: `Trial.to_json` of each trial.
        expected: Versions and digests that the trials need; None accepts any.

    Raises:
        WorkerMismatchError: This process has another version or configuration than
            `expected`.
        StationError: The setup cannot be used here.
    """
    with _one_at_a_time:
        if expected is not None and setup_text not in _checked:
            compare(expected, identity(setup_text), WORKER)
            _checked.add(setup_text)
        setup = Setup(setup_text)
        world = kept_world(setup)
        return [world.run(Trial.from_json(setup, text)) for text in trial_texts]


def compare(expected: Identity, found: Identity, worker: str) -> None:
    """Refuse a worker that would compute other results.

    Raises:
        WorkerMismatchError: This process would give other results; the message says
            why.
    """
    for field in fields(Identity):
        wanted, has = getattr(expected, field.name), getattr(found, field.name)
        if wanted != has:
            raise WorkerMismatchError(
                f"Worker {worker} has {field.name} {has}; the experiment has {wanted}.",
                remedy="Install the same versions and files there, and start it again.",
                details={"worker": worker, "what": field.name},
            )


def be_polite(niceness: int) -> None:
    """Lower the priority of this process, unless it is already as low.

    Args:
        niceness: The niceness to have, 0 to 19.
    """
    # A process inherits the priority of the station's thread that starts it, which may
    # be high.
    present = os.getpriority(os.PRIO_PROCESS, 0)
    os.setpriority(os.PRIO_PROCESS, 0, max(niceness, present))


def begin_worker(niceness: int) -> None:
    """Prepare a worker process: set its niceness, and let it end with its parent.

    Args:
        niceness: The niceness to have, 0 to 19.
    """
    be_polite(niceness)
    # At the end without taking its worlds apart: Ruckig prints a page of warnings about
    # what is left of them, and all results have been sent by then.
    atexit.register(os._exit, 0)
    # Ignore Ctrl-C, because the parent handles it: the running trials may end.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent,), daemon=True).start()


def _end_with(parent: BaseProcess) -> None:
    """End this process when its parent has ended, for whatever reason."""
    parent.join()
    os._exit(1)


def kept_world(setup: Setup) -> TrialWorld:
    """Return the world of a setup; build it if this process does not keep it yet."""
    world = _worlds.pop(setup.digest, None)
    if world is None:
        world = TrialWorld(setup)
    _worlds[setup.digest] = world
    while len(_worlds) > _WORLDS:
        _worlds.popitem(last=False)[1].close()
    return world
