"""From the core's report on the robot to its wire models."""

from collections.abc import Iterable

from station import wire as schemas
from station.api.wire_numbers import measured
from station.core.facade.hardware_report import HardwareReport, InterfaceReport
from station.core.hardware.limits import SoftJointLimits
from station.core.hardware.robot_report import (
    ClampReport,
    JointLimitsReport,
    TransmissionReport,
)


def hardware(report: HardwareReport) -> schemas.Hardware:
    """Return the whole report."""
    return schemas.Hardware(
        interfaces=[_interface(found) for found in report.interfaces],
        limits=[_limits(found) for found in report.limits],
        transmissions=[_transmission(found) for found in report.transmissions],
        clamps=clamps(report.clamps),
    )


def clamps(reports: Iterable[ClampReport]) -> list[schemas.Clamp]:
    """Return what limits have cut off."""
    return [
        schemas.Clamp(
            joint=report.last.joint,
            hardware_interface=report.hardware_interface,
            count=report.count,
            asked=measured(report.last.asked),
            given=measured(report.last.given),
            reason=report.last.reason.value,
        )
        for report in reports
    ]


def _interface(report: InterfaceReport) -> schemas.HardwareInterface:
    return schemas.HardwareInterface(
        name=report.name,
        resources=[
            schemas.HardwareResource(name=r.name, claimed_by=list(r.claimed_by))
            for r in report.resources
        ],
    )


def _limits(report: JointLimitsReport) -> schemas.HardwareLimits:
    limits = report.limits
    return schemas.HardwareLimits(
        joint=report.joint,
        min_position=_bound(limits.min_position),
        max_position=_bound(limits.max_position),
        max_velocity=_bound(limits.max_velocity),
        max_acceleration=_bound(limits.max_acceleration),
        max_jerk=_bound(limits.max_jerk),
        max_effort=_bound(limits.max_effort),
        soft_limits=_soft_limits(report.soft_limits),
        sources=dict(report.sources),
    )


def _soft_limits(found: SoftJointLimits | None) -> schemas.SoftLimits | None:
    if found is None:
        return None
    return schemas.SoftLimits(
        min_position=measured(found.min_position),
        max_position=measured(found.max_position),
        k_position=found.k_position,
        k_velocity=found.k_velocity,
    )


def _transmission(report: TransmissionReport) -> schemas.HardwareTransmission:
    return schemas.HardwareTransmission(
        name=report.name,
        type=report.type,
        joints=list(report.joints),
        actuators=list(report.actuators),
    )


def _bound(value: float | None) -> float | None:
    return None if value is None else measured(value)
