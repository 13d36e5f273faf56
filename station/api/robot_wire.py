"""From arms as the core describes them to the wire models, and back."""

from dataclasses import fields
from typing import Any

from station import wire as schemas
from station.api.wire_numbers import measured, measured_list
from station.core.facade.robots import ArmModelReport, ArmReport
from station.core.franka import (
    ArmError,
    ArmRecord,
    CollisionBehavior,
    FaultKind,
    RobotMode,
    RobotState,
    SimulatedFault,
)
from station.core.franka.franka_errors import error_names

_FLAGS = ("current_errors", "last_motion_errors")


def arm_report(found: ArmReport) -> schemas.ArmReport:
    """Return an arm at a glance."""
    return schemas.ArmReport(
        arm_id=found.arm_id,
        robot_mode=found.mode.name.lower(),  # type: ignore[arg-type]  # the same names
        connected=found.is_connected,
        errors=[arm_error(error) for error in found.errors],
        remedy=_remedy(found),
    )


def _remedy(found: ArmReport) -> str:
    """Return what to do before the arm can move, with the route that does it."""
    if found.remedy is not None and found.mode is RobotMode.REFLEX:
        return f"{found.remedy} (POST /robots/{found.arm_id}/error_recovery)"
    return found.remedy or ""


def arm_error(found: ArmError) -> schemas.ArmError:
    """Return one error."""
    return schemas.ArmError(
        name=found.name,
        where=found.where,
        value=measured(found.value),
        limit=measured(found.limit),
        unit=found.unit,
        cycle=found.cycle,
        description=found.describe(),
    )


def franka_state(found: RobotState) -> schemas.FrankaState:
    """Return the whole state; the errors by their names."""
    values: dict[str, Any] = {"robot_mode": found.robot_mode.name.lower()}
    for one in fields(found):
        value = getattr(found, one.name)
        if one.name in _FLAGS:
            values[one.name] = error_names(value)
        elif isinstance(value, list):
            values[one.name] = measured_list(value)
        elif isinstance(value, float):
            values[one.name] = value
    return schemas.FrankaState(**values)


def arm_record(found: ArmRecord) -> schemas.ArmRecord:
    """Return one of the last cycles."""
    return schemas.ArmRecord(
        time=found.time,
        q=measured_list(found.q),
        dq=measured_list(found.dq),
        tau_J=measured_list(found.tau_J),
        q_d=measured_list(found.q_d),
        tau_J_d=measured_list(found.tau_J_d),
        command=measured_list(found.command),
    )


def active_fault(found: SimulatedFault) -> schemas.ActiveFault:
    """Return what goes wrong."""
    return schemas.ActiveFault(
        kind=found.kind.value, cycles=found.cycles, joint=found.joint
    )


def arm_model(found: ArmModelReport) -> schemas.ArmModel:
    """Return what the model says."""
    return schemas.ArmModel(
        frame=found.frame.name.lower(),  # type: ignore[arg-type]  # the same names
        mass=measured_list(found.mass),
        coriolis=measured_list(found.coriolis),
        gravity=measured_list(found.gravity),
        pose=measured_list(found.pose),
        zero_jacobian=measured_list(found.zero_jacobian),
        body_jacobian=measured_list(found.body_jacobian),
    )


def collision_behavior(
    request: schemas.ForceTorqueCollisionBehavior,
) -> CollisionBehavior:
    """Return the thresholds; those of acceleration are the nominal ones if not told."""
    given = request.model_dump()
    chosen = {
        one.name: given.get(
            one.name, given[one.name.replace("acceleration", "nominal")]
        )
        for one in fields(CollisionBehavior)
    }
    return CollisionBehavior(**{name: tuple(v) for name, v in chosen.items()})


def fault(request: schemas.Fault) -> SimulatedFault:
    """Return what shall go wrong."""
    x, y, z = request.force
    kind = FaultKind(request.kind)
    return SimulatedFault(kind, request.cycles, request.joint, (x, y, z))
