"""What both Cartesian controllers share: parameters, start, and what they say."""

import pytest

from station.controllers.cartesian_motion import (
    CartesianJogController,
    CartesianStreamingController,
)
from station.core.errors import ParameterError, RobotDescriptionError

BOTH = pytest.mark.parametrize(
    "kind", [CartesianJogController, CartesianStreamingController]
)


@BOTH
def test_set_points_are_short_lived_by_default(arm, kind):
    port = arm.load(kind).set_points

    assert (port.timeout, port.longest) == (0.2, 1.0)
    assert arm.load(kind, command_timeout=0.5).set_points.timeout == 0.5
    with pytest.raises(ParameterError, match="command_timeout"):
        arm.load(kind, command_timeout=0.0)
    with pytest.raises(ParameterError, match="command_timeout_action"):
        arm.load(kind, command_timeout_action="off")


@BOTH
def test_cartesian_motion_is_not_loaded_without_joint_limits(arm, kind):
    arm.tree.delete("robot_description")

    with pytest.raises(RobotDescriptionError):
        arm.load(kind)


@BOTH
def test_the_first_command_is_where_the_end_effector_is_meant_to_be(arm, kind):
    arm.start(kind)

    assert arm.command == pytest.approx(arm.state.O_T_EE_d, abs=1e-12)


@BOTH
def test_the_published_state_of_free_motion_has_no_obstacle(arm, kind):
    controller = arm.start(kind)
    arm.run(controller, 3)

    state = controller.published()["state"]
    assert state == {"obstacle": "none", "joint": "", "message": ""}


def test_what_was_in_the_way_is_told_for_a_moment(arm, send):
    controller = arm.start(CartesianJogController, joint_velocity_share=0.01)
    for _ in range(10):
        send(controller, [0.1, 0.0, 0.0, 0.0, 0.0, 0.0])
        arm.run(controller, 50)
    state = controller.published()["state"]
    assert state["obstacle"] == "joint_speed"
    assert state["joint"] in state["message"]
    send(controller, [0.0] * 6)
    arm.run(controller, 1_000)

    assert controller.published()["state"]["obstacle"] == "none"
