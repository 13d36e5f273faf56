"""Trials on the workers of a Dask scheduler."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from station.experiments.pools import InThisProcess
from station.experiments.tuning import tune
from station.trials.results import Results
from station.trials.trial import Setup
from tests.experiments.cluster_trials import GAINS, OBJECTIVE, SEARCH, first_trial

ROOT = Path(__file__).parents[2]


@pytest.mark.long
@pytest.mark.alone
def test_search_finds_the_same_when_workers_go_and_come(tmp_path):
    """A worker is killed and one added: no trial is lost, none is counted twice."""
    with Results.create(tmp_path / "l.sqlite", "tune", Setup.load(), {}) as results:
        here = tune(first_trial(), GAINS, OBJECTIVE, SEARCH, results, InThisProcess())
        rows = {row.result.hash: dict(row.result.metrics) for row in results.rows()}

    result = subprocess.run(
        [
            sys.executable,
            "-m",
            "tests.experiments.cluster_trials",
            tmp_path / "c.sqlite",
        ],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )

    assert result.returncode == 0, result.stderr
    found = json.loads(result.stdout.splitlines()[-1])
    assert len(found["lost"]) == 1
    # The two at the beginning, and at least one of those that came later.
    assert len(found["workers"]) >= 3
    assert len(found["metrics"]) == len(rows) == SEARCH.trials
    assert dict(found["metrics"]) == rows
    assert found["best"] == [here.best.hash, here.best_cost, dict(here.best.parameters)]


@pytest.mark.slow
def test_scheduler_that_does_not_answer_is_told_by_name():
    script = (
        "from station.experiments.cluster import ClusterExecutor\n"
        "from station.trials.trial import Setup\n"
        "ClusterExecutor('tcp://127.0.0.1:9', Setup.load().text, timeout=0.5)\n"
    )

    result = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=False
    )

    assert "The scheduler tcp://127.0.0.1:9 does not answer" in result.stderr
