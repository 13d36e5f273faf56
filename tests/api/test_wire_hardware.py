"""The report on the robot becomes JSON without loss."""

import math

from station.api import wire_hardware
from station.core.facade.hardware_report import (
    HardwareReport,
    InterfaceReport,
    ResourceReport,
)
from station.core.hardware.limits import (
    Clamp,
    ClampReason,
    JointLimits,
    SoftJointLimits,
)
from station.core.hardware.robot_report import (
    ClampReport,
    JointLimitsReport,
    TransmissionReport,
)

EFFORT = "hardware_interface::EffortJointInterface"


def test_everything_is_told():
    report = HardwareReport(
        (InterfaceReport(EFFORT, (ResourceReport("j", ("arm",)),)),),
        (
            JointLimitsReport(
                "j",
                JointLimits(min_position=-1.0, max_position=1.0, max_effort=math.inf),
                SoftJointLimits(-0.9, 0.9, 10.0, 20.0),
                {"position": "urdf limit", "soft": "parameters"},
            ),
        ),
        (TransmissionReport("t", "a/B", ("j",), ("m",)),),
        (ClampReport(EFFORT, 3, Clamp("j", math.inf, 5.0, ClampReason.EFFORT)),),
    )

    told = wire_hardware.hardware(report)

    assert told.interfaces[0].resources[0].claimed_by == ["arm"]
    limits = told.limits[0]
    assert (limits.min_position, limits.max_velocity) == (-1.0, None)
    assert limits.max_effort is None
    assert limits.soft_limits.k_velocity == 20.0
    assert limits.sources == {"position": "urdf limit", "soft": "parameters"}
    assert told.transmissions[0].actuators == ["m"]
    clamp = told.clamps[0]
    assert (clamp.count, clamp.asked, clamp.given) == (3, None, 5.0)
    assert clamp.reason == "effort"
