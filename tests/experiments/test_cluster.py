"""Trials on the workers of a Dask scheduler."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from station.trials.script import Script
from station.trials.trial import Trial
from station.wire.excitations import Step
from tests.experiments.conftest import GROUP

ROOT = Path(__file__).parents[2]


@pytest.mark.slow
@pytest.mark.alone
def test_no_trial_is_lost_or_counted_twice_when_workers_go_and_come(
    tmp_path, panda, world
):
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
    assert found["ended"] == 24
    assert len(set(found["hashes"])) == len(found["hashes"]) == 24
    assert len(found["lost"]) == 1
    assert len(found["workers"]) >= 2
    motion = Step(joint="panda_joint1", amplitude=0.05)
    script = Script(controller=GROUP, duration=0.2, commands=(motion,))
    trial = Trial(panda, script, {"load": 0.5})
    assert found["metrics"][trial.hash] == world.run(trial).metrics


@pytest.mark.slow
def test_scheduler_that_does_not_answer_is_told_by_name():
    script = (
        "from station.experiments.cluster import ClusterExecutor\n"
        "from station.trials.setup import Setup\n"
        "ClusterExecutor('tcp://127.0.0.1:9', Setup.load().text, timeout=0.5)\n"
    )

    result = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=False
    )

    assert "The scheduler tcp://127.0.0.1:9 does not answer" in result.stderr
