"""Controllers that forward positions."""

import pytest

from station.controllers.position_controllers import (
    JointGroupPositionController,
    JointPositionController,
)


@pytest.mark.parametrize(
    ("controller_class", "names"),
    [
        (JointPositionController, {"joint": "elbow"}),
        (JointGroupPositionController, {"joints": ["elbow", "wheel"]}),
    ],
)
def test_a_forwarding_controller_claims_its_joints_for_position_commands(
    robot, controller_class, names
):
    controller = robot.load(controller_class, **names)
    (claimed,) = controller.claims
    assert claimed.hardware_interface == "hardware_interface::PositionJointInterface"
    assert claimed.resources[0] == "elbow"
    assert controller.set_points.elements[0].unit == "rad"
