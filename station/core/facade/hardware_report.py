"""The robot's interfaces and who claims what, with limits and transmissions."""

from collections.abc import Sequence
from dataclasses import dataclass

from station.core.control.controller import ControllerState
from station.core.control.controller_status import ControllerStatus
from station.core.description.repair import Repair
from station.core.hardware.robot_hw import RobotHW
from station.core.hardware.robot_report import ClampReport, JointLimitsReport
from station.reports import HardwareInterface, HardwareResource, HardwareTransmission


@dataclass(frozen=True, slots=True)
class HardwareReport:
    """Everything about the robot that changes rarely.

    Attributes:
        interfaces: What controllers can ask for.
        limits: The joints' limits.
        transmissions: What is between actuators and joints.
        clamps: What was cut off by limits.
        repairs: In what the robot differs from its description.
    """

    interfaces: tuple[HardwareInterface, ...]
    limits: tuple[JointLimitsReport, ...]
    transmissions: tuple[HardwareTransmission, ...]
    clamps: tuple[ClampReport, ...]
    repairs: tuple[Repair, ...]


def report_hardware(
    robot: RobotHW, controllers: Sequence[ControllerStatus]
) -> HardwareReport:
    """Return the report on a robot. Any thread.

    Args:
        robot: The robot; its interfaces do not change after `init`.
        controllers: The loaded controllers.
    """
    claims: dict[tuple[str, str], list[str]] = {}
    for status in controllers:
        if status.state is not ControllerState.RUNNING:
            continue
        for claimed in status.claimed_resources:
            for resource in claimed.resources:
                key = (claimed.hardware_interface, resource)
                claims.setdefault(key, []).append(status.name)
    interfaces = [
        HardwareInterface(
            name,
            tuple(
                HardwareResource(resource, tuple(claims.get((name, resource), ())))
                for resource in robot.get_interface_resources(name)
            ),
        )
        for name in robot.get_names()
    ]
    return HardwareReport(
        tuple(interfaces),
        tuple(robot.joint_limits()),
        tuple(robot.transmissions()),
        tuple(robot.clamps()),
        tuple(robot.repairs()),
    )
