"""An arm in front of a wall, in its ready pose."""

import pytest

import station
from tests.rehearsal.test_rehearsals import WALL, begin


@pytest.fixture(scope="module")
def robot():
    with station.open({"scene": {"objects": [WALL]}}) as opened:
        yield opened


@pytest.fixture
def ready(robot):
    """Return a function that starts a controller on the robot in its ready pose."""
    return lambda controller: begin(robot, controller)
