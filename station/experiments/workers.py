"""The work of a worker process: trials, in worlds that it keeps between them.

Only plain text travels to a worker and back, so that any executor can carry it.
"""

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
"""How many worlds a worker keeps."""
WORKER = f"{platform.node()}:{os.getpid()}"
"""This process: host and process."""
_one_at_a_time = threading.Lock()
"""A worker of a cluster may have several threads; a world has one."""
_checked: set[str] = set()
"""The setups for which this process has been compared with the experiment."""
_worlds: "OrderedDict[str, TrialWorld]" = OrderedDict()


@dataclass(frozen=True, slots=True)
class Identity:
    """The facts that must be equal on all machines that run an experiment's trials.

    Attributes:
        station: Version of the station, and a digest of its arithmetic.
        mujoco: Version of MuJoCo.
        setup: Digest of the setup as the worker has read it, and the masses of its
            robot, which come from files that do not travel.
    """

    station: str
    mujoco: str
    setup: str


def identity(setup_text: str) -> Identity:
    """Return the identity of this process as a place for trials.

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
    """Run trials one after the other; the error of a trial is in its result.

    Args:
        setup_text: Text of the setup.
        trial_texts: `Trial.to_json` of each trial.
        expected: Version and configuration that trials need; any when None.

    Raises:
        WorkerMismatchError: This process has another version or configuration.
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
    """Refuse a worker that would give other numbers.

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
    """Lower the priority of this process, if it is not as low already.

    Args:
        niceness: The niceness to have, 0 to 19.
    """
    # Threads of a station may have a high priority, which their processes inherit.
    present = os.getpriority(os.PRIO_PROCESS, 0)
    os.setpriority(os.PRIO_PROCESS, 0, max(niceness, present))


def begin_worker(niceness: int) -> None:
    """Prepare a worker process: set its niceness, and let it end with its parent.

    Args:
        niceness: The niceness to have, 0 to 19.
    """
    be_polite(niceness)
    # The parent decides what Ctrl-C means: trials that run may end.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent,), daemon=True).start()


def _end_with(parent: BaseProcess) -> None:
    """End this process when its parent is gone, however that ended."""
    parent.join()
    os._exit(1)


def kept_world(setup: Setup) -> TrialWorld:
    """Return the world of a setup that this process keeps; it is built once."""
    world = _worlds.pop(setup.digest, None)
    if world is None:
        world = TrialWorld(setup)
    _worlds[setup.digest] = world
    while len(_worlds) > _WORLDS:
        _worlds.popitem(last=False)[1].close()
    return world
