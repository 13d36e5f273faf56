"""Setups and scripts of short trials."""

import pytest

from station.experiments.trial_world import TrialWorld
from station.trials.results import Results
from station.trials.trial import Script, Setup, Trial, TrialResult
from station.wire.excitations import Step

GROUP = "effort_group_position_controller"


@pytest.fixture(scope="session")
def panda() -> Setup:
    """The default configuration with an arm whose readings are exact."""
    return Setup.load(settings={"robot.realism": "ideal"})


@pytest.fixture(scope="session")
def step(panda: Setup) -> Trial:
    """A step of joint 1 within 0.15 s."""
    motion = Step(joint="panda_joint1", amplitude=0.05, at=0.01)
    return Trial(panda, Script(controller=GROUP, duration=0.15, commands=(motion,)))


@pytest.fixture(scope="session")
def world(panda: Setup) -> TrialWorld:
    """A world that many tests use: no trial leaves anything behind."""
    return TrialWorld(panda)


def fill(path, step, errors, kind="sweep", plan=None):
    """Return results whose trials have these errors; None for one that failed."""
    results = Results.create(path, kind, step.setup, plan or {})
    for number, error in enumerate(errors):
        trial = step.with_parameters({"load": 0.1 * number})
        metrics = (
            {} if error is None else {"rms_error": error, "effort_rms": 1.0 / error}
        )
        state = "failed" if error is None else "done"
        reason = "It fell." if error is None else None
        results.add(trial, TrialResult(trial.hash, state, reason, metrics, 0.1, "w"))
    return results


@pytest.fixture
def results(tmp_path, step):
    with fill(tmp_path / "some.sqlite", step, [3.0, 1.0, None, 2.0]) as found:
        yield found
