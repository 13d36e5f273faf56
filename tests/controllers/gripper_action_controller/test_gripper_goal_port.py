"""Goals of grippers as clients send them."""

import pytest

from station.core.errors import ControllerStateError, InvalidCommandError


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        ({}, "goal is"),
        ({"command": 3}, "goal is"),
        ({"command": {}}, "command/position"),
        ({"command": {"position": "0.1"}}, "command/position"),
        ({"command": {"position": True}}, "command/position"),
        ({"command": {"position": None}}, "command/position"),
        ({"command": {"position": float("nan")}}, "command/position"),
        ({"command": {"position": 0.1, "max_effort": float("inf")}}, "max_effort"),
        ({"command": {"position": 0.1, "speed": 1.0}}, "speed"),
        ({"command": {"position": 0.1}, "width": 1.0}, "goal is"),
        ({"command": {"position": 0.51}}, "allowed is -0.5 to 0.5"),
        ({"command": {"position": -0.51}}, "allowed is -0.5 to 0.5"),
    ],
)
def test_a_malformed_goal_is_refused_and_changes_nothing(
    robot, start, request_, message
):
    controller = start()

    with pytest.raises(InvalidCommandError, match=message):
        controller.goals.submit(request_)

    robot.run_with_position(controller, 100)
    assert robot.position == [0.0, 0.0, 0.0]
    assert controller.goals.goals() == []


def test_goals_need_a_running_controller(robot, start, submit):
    controller = start()
    controller.stop_request(robot.time)

    with pytest.raises(ControllerStateError, match="not running"):
        submit(controller, 0.1)


def test_whole_numbers_are_numbers(start, submit):
    controller = start()

    submit(controller, 0, max_effort=1)

    ((_, command),) = controller.goals.waiting
    assert (command.position, command.max_effort) == (0.0, 1.0)


def test_the_sign_of_the_effort_does_not_count(start, submit):
    controller = start()

    submit(controller, 0.1, max_effort=-3.0)
    submit(controller, 0.1)

    efforts = [command.max_effort for _, command in controller.goals.waiting]
    assert efforts == [3.0, 50.0]  # 50 N is the limit of the joint
