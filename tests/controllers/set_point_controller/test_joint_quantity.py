"""Units, ranges and measured values of the three quantities."""

import pytest

from station.controllers.set_point_controller import (
    ControlledJoints,
    JointQuantity,
)
from station.core.description.robot_description import JointDescription
from station.core.description.urdf import JointType
from station.core.hardware.interfaces import JointStateGroup, JointStateHandle

ELBOW = JointDescription("elbow", JointType.REVOLUTE, -1.0, 2.0, 3.0, 4.0)
SLIDE = JointDescription("slide", JointType.PRISMATIC, -1.0, 2.0, 3.0, 4.0)


@pytest.mark.parametrize(
    ("quantity", "angular", "linear", "bounds"),
    [
        (JointQuantity.POSITION, "rad", "m", (-1.0, 2.0)),
        (JointQuantity.VELOCITY, "rad/s", "m/s", (-3.0, 3.0)),
        (JointQuantity.EFFORT, "Nm", "N", (-4.0, 4.0)),
    ],
)
def test_unit_and_range_follow_the_joint(quantity, angular, linear, bounds):
    assert quantity.unit(ELBOW) == angular
    assert quantity.unit(SLIDE) == linear
    assert quantity.range(ELBOW) == bounds


def test_the_measured_value_is_that_of_the_quantity():
    group = JointStateGroup([JointStateHandle("elbow", [1.0], [2.0], [3.0])])
    memory = ControlledJoints(group)
    memory.read()
    values = [quantity.measured(memory).tolist() for quantity in JointQuantity]
    assert values == [[1.0], [2.0], [3.0]]
