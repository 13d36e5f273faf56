"""The kinds of command that a simulated joint takes."""

from collections.abc import Mapping

from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointCommandInterface,
    PositionJointInterface,
    VelocityJointInterface,
)

COMMAND_INTERFACES: Mapping[str, type[JointCommandInterface]] = {
    "position": PositionJointInterface,
    "velocity": VelocityJointInterface,
    "effort": EffortJointInterface,
}
"""The interface through which controllers command each quantity."""
