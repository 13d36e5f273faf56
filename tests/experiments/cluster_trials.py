"""A search on a cluster of this machine that loses a worker and gets another one.

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
from station.experiments.tuning import Search, tune
from station.trials.objective import Bound, Objective
from station.trials.results import Results
from station.trials.trial import Script, Setup, Trial
from station.wire.excitations import Step

GROUP = "effort_group_position_controller"
GAINS = {f"gains/{GROUP}/panda_joint1/p": 120.0, f"gains/{GROUP}/panda_joint1/d": 150.0}
OBJECTIVE = Objective(bounds=(Bound("violations", 0.0),))
SEARCH = Search(trials=31)


def first_trial() -> Trial:
    """Return where the search begins."""
    motion = Step(joint="panda_joint1", amplitude=0.05)
    script = Script(controller=GROUP, duration=0.2, commands=(motion,))
    return Trial(Setup.load(), script, GAINS)


def main() -> None:
    """Run the search."""
    first = first_trial()
    lost: list[int] = []
    with (
        LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50
        ) as cluster,
        Results.create(Path(sys.argv[1]), "tune", first.setup, {}) as results,
        ClusterExecutor(
            cluster.scheduler_address, first.setup.text, look_after=0.0
        ) as executor,
    ):

        def disturb(progress: Progress) -> None:
            if progress.ended >= 9 and not lost:
                worker = results.rows()[-1].result.worker
                lost.append(int(worker.rpartition(":")[2]))
                os.kill(lost[0], signal.SIGKILL)
                cluster.scale(3)
            if progress.ended >= 14:  # the search goes on without them until here
                cluster.wait_for_workers(3, timeout=60)

        tuned = tune(first, GAINS, OBJECTIVE, SEARCH, results, executor, disturb)
        rows = results.rows()
    sys.stdout.write(
        json.dumps({
            "best": [tuned.best.hash, tuned.best_cost, dict(tuned.best.parameters)],
            "metrics": [[r.result.hash, dict(r.result.metrics)] for r in rows],
            "workers": sorted({row.result.worker for row in rows}),
            "lost": lost,
        })
    )


if __name__ == "__main__":
    main()
