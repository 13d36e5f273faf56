"""A client of libfranka's protocol at an arm that obeys the tests."""

import pytest

from tests.hw.franka.fci.server.robot_client import RobotClient
from tests.hw.franka.scripted_arm import ScriptedArm


@pytest.fixture
def arm():
    return ScriptedArm()


@pytest.fixture
def client(arm):
    """A client that is connected and has seen a state."""
    made = RobotClient(arm)
    made.connect()
    made.cycle()
    return made
