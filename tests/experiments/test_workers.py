"""A worker that would give other numbers gets no trial."""

from dataclasses import replace

import pytest

from station.experiments import pools
from station.experiments.pools import compare, identity, run_trials
from station.trials.errors import WorkerMismatchError


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
