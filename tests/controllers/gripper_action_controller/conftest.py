"""A gripper whose finger follows position commands until something is in between."""

import pytest

from station.controllers.gripper_action_controller import (
    PositionGripperActionController,
)


@pytest.fixture
def start(robot):
    """Return a way to start a controller that commands the position of `slide`."""

    def start_controller(**values):
        return robot.start(
            PositionGripperActionController, **({"joint": "slide"} | values)
        )

    return start_controller


@pytest.fixture
def submit():
    """Return a way to submit a goal."""

    def submit_goal(controller, position, **fields):
        return controller.goals.submit({"command": {"position": position, **fields}})

    return submit_goal
