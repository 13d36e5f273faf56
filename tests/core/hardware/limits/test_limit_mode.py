"""Which handle enforces what."""

import pytest

from station.core.errors import ParameterError
from station.core.hardware.interfaces import JointHandle, JointStateHandle
from station.core.hardware.limits import (
    EffortJointSaturationHandle,
    EffortJointSoftLimitsHandle,
    JointLimits,
    LimitMode,
    PositionJointRateLimitsHandle,
    PositionJointSaturationHandle,
    PositionJointSoftLimitsHandle,
    SoftJointLimits,
    VelocityJointRateLimitsHandle,
    VelocityJointSaturationHandle,
    VelocityJointSoftLimitsHandle,
    make_limits_handle,
)
from station.core.parameters import Parameters

LIMITS = JointLimits(-1.0, 1.0, max_velocity=2.0, max_effort=5.0)
SOFT = SoftJointLimits(-0.9, 0.9, 10.0, 5.0)
JOINT = JointHandle(JointStateHandle("j", [0.0], [0.0], [0.0]), [0.0])
ROS_CONTROL, RATE = LimitMode.ROS_CONTROL, LimitMode.RATE


@pytest.mark.parametrize(
    ("mode", "quantity", "soft", "expected"),
    [
        (ROS_CONTROL, "position", None, PositionJointSaturationHandle),
        (ROS_CONTROL, "velocity", None, VelocityJointSaturationHandle),
        (ROS_CONTROL, "effort", None, EffortJointSaturationHandle),
        (ROS_CONTROL, "position", SOFT, PositionJointSoftLimitsHandle),
        (ROS_CONTROL, "velocity", SOFT, VelocityJointSoftLimitsHandle),
        (ROS_CONTROL, "effort", SOFT, EffortJointSoftLimitsHandle),
        (RATE, "position", SOFT, PositionJointRateLimitsHandle),
        (RATE, "velocity", SOFT, VelocityJointRateLimitsHandle),
        (RATE, "effort", SOFT, EffortJointSaturationHandle),
        (RATE, "position", None, PositionJointRateLimitsHandle),
    ],
)
def test_handle_is_chosen_by_mode_quantity_and_soft_limits(
    mode, quantity, soft, expected
):
    assert type(make_limits_handle(mode, quantity, JOINT, LIMITS, soft)) is expected


def test_mode_is_that_of_ros_control_unless_it_is_given():
    params = Parameters()
    assert LimitMode.from_parameters(params) is ROS_CONTROL
    params.set("limit_mode", "rate")
    assert LimitMode.from_parameters(params) is RATE


def test_unknown_mode_is_refused_with_the_known_ones():
    params = Parameters()
    params.set("robot", {"limit_mode": "soft"})
    with pytest.raises(ParameterError, match="must be one of ros_control, rate"):
        LimitMode.from_parameters(params.namespace("robot"))
