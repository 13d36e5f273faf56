"""A PID around the velocity, the case without any angles."""

import pytest

from station.controllers.effort_controllers import (
    JointGroupPositionController,
    JointVelocityController,
)


def _start(robot):
    return robot.start(JointVelocityController, joint="elbow", pid={"p": 5.0})


def test_it_starts_at_rest(robot):
    controller = _start(robot)
    robot.step(controller)
    assert robot.efforts_commanded == [0.0, 0.0, 0.0]


def test_the_error_is_the_missing_velocity(robot, send):
    controller = _start(robot)
    robot.velocity[1] = 0.4
    send(controller, [1.0])
    robot.step(controller)
    assert robot.efforts_commanded[1] == pytest.approx(3.0)
    assert controller.sample.desired == [1.0]
    assert controller.sample.actual == [0.4]
    assert controller.sample.error == pytest.approx([0.6])
    assert controller.sample.output == pytest.approx([3.0])


def test_gains_change_by_name(robot, send):
    controller = _start(robot)
    changed = controller.gains() | {"elbow/p": 7.0}
    controller.check_gains(changed)
    controller.apply_gains(changed)
    send(controller, [1.0])
    robot.step(controller)
    assert robot.efforts_commanded[1] == pytest.approx(7.0)
    assert controller.gain_schema()["elbow/p"].unit == "Nm s/rad"


def test_its_state_is_that_of_the_original(robot, send):
    controller = robot.start(
        JointVelocityController,
        joint="elbow",
        pid={"p": 5.0, "i": 1.0, "d": 0.5, "i_clamp": 2.0, "antiwindup": True},
    )
    assert controller.published() == {}
    robot.velocity[1] = 0.4
    send(controller, [1.0])
    robot.step(controller)
    state = controller.published()["state"]
    assert state == {
        "stamp": robot.time,
        "time_step": 0.001,
        "set_point": 1.0,
        "process_value": 0.4,
        "error": pytest.approx(0.6),
        "command": controller.sample.output[0],
        "p": 5.0,
        "i": 1.0,
        "d": 0.5,
        "i_clamp": 2.0,
        "antiwindup": True,
    }


def test_the_state_of_a_group_has_one_number_for_each_joint(robot):
    controller = robot.start(
        JointGroupPositionController,
        joints=["slide", "elbow"],
        gains={"slide": {"p": 5.0}, "elbow": {"p": 7.0}},
    )
    robot.step(controller)
    state = controller.published()["state"]
    assert state["joint_names"] == ["slide", "elbow"]
    assert state["p"] == [5.0, 7.0]
    assert state["set_point"] == state["process_value"] == [0.0, 0.0]
