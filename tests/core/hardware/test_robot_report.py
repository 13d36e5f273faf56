"""What robots tell about limits and clamps."""

from station.core.hardware.interfaces import JointHandle, JointStateHandle
from station.core.hardware.limits import (
    ClampReason,
    JointLimits,
    PositionJointSaturationHandle,
    SoftJointLimits,
)
from station.core.hardware.robot_report import limit_values, report_clamps


def test_only_limits_that_exist_are_values():
    limits = JointLimits(min_position=-1.0, max_position=2.0, max_effort=0.0)
    soft = SoftJointLimits()
    assert limit_values(limits, None) == {"position": (-1.0, 2.0), "effort": 0.0}
    assert limit_values(JointLimits(), soft) == {"soft": soft}


def test_handles_that_never_clamped_are_not_told():
    state = JointStateHandle("j", [0.0], [0.0], [0.0])
    command = [0.0]
    limits = JointLimits(min_position=-1.0, max_position=1.0)
    handle = PositionJointSaturationHandle(JointHandle(state, command), limits)
    handles = {("j", "PositionJoint"): handle}

    handle.enforce_limits(0.001)
    assert report_clamps(handles) == []

    for _ in range(3):
        command[0] = 5.0
        handle.enforce_limits(0.001)
    (report,) = report_clamps(handles)
    assert (report.hardware_interface, report.count) == ("PositionJoint", 3)
    last = report.last
    assert (last.joint, last.asked, last.given) == ("j", 5.0, 1.0)
    assert last.reason is ClampReason.POSITION
