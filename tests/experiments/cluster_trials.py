"""A sweep on a cluster of this machine that loses a worker and gets another one.

Run by `test_cluster.py` in a process of its own: `python -m ... FILE.sqlite`. Prints
what became of the trials as JSON.
"""

import json
import os
import signal
import sys
from pathlib import Path

from distributed import LocalCluster

from station.experiments.cluster import ClusterExecutor
from station.experiments.runner import Progress
from station.experiments.sweep import sweep
from station.trials.results import Results
from station.trials.script import Script
from station.trials.setup import Setup
from station.trials.trial import Trial
from station.wire.excitations import Step

TRIALS = 24


def main() -> None:
    """Run the sweep."""
    setup = Setup.load()
    motion = Step(joint="panda_joint1", amplitude=0.05)
    group = "effort_group_position_controller"
    base = Trial(setup, Script(controller=group, duration=0.2, commands=(motion,)))
    points = [{"load": 0.05 * number} for number in range(TRIALS)]
    lost: list[int] = []
    with (
        LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50
        ) as cluster,
        Results.create(Path(sys.argv[1]), "sweep", setup, {}) as results,
        ClusterExecutor(cluster.scheduler_address, setup.text) as executor,
    ):

        def disturb(progress: Progress) -> None:
            if progress.ended == 4:
                worker = results.rows()[-1].result.worker
                lost.append(int(worker.rpartition(":")[2]))
                os.kill(lost[0], signal.SIGKILL)
                cluster.scale(3)

        progress = sweep(base, points, results, executor, disturb)
        rows = results.rows()
    sys.stdout.write(
        json.dumps({
            "ended": progress.ended,
            "hashes": [row.result.hash for row in rows],
            "metrics": {row.result.hash: dict(row.result.metrics) for row in rows},
            "workers": sorted({row.result.worker for row in rows}),
            "lost": lost,
        })
    )


if __name__ == "__main__":
    main()
