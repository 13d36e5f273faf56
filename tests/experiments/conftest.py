"""Setups and scripts of short trials."""

import pytest

from station.experiments.script import Script, Step
from station.experiments.setup import Setup
from station.experiments.trial import Trial
from station.experiments.trial_world import TrialWorld

GROUP = "effort_group_position_controller"


@pytest.fixture(scope="session")
def panda() -> Setup:
    """The default configuration."""
    return Setup.load()


@pytest.fixture(scope="session")
def step(panda: Setup) -> Trial:
    """A step of joint 1 within 0.15 s."""
    motion = Step(joint="panda_joint1", amplitude=0.05, at=0.01)
    return Trial(panda, Script(controller=GROUP, duration=0.15, commands=(motion,)))


@pytest.fixture(scope="session")
def world(panda: Setup) -> TrialWorld:
    """A world that many tests use: no trial leaves anything behind."""
    return TrialWorld(panda)
