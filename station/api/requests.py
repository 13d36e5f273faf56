"""Requests whose structure differs from that of the core's values."""

from dataclasses import fields

from station import wire
from station.core.franka import (
    CollisionBehavior,
    FaultKind,
    GraspRequest,
    SimulatedFault,
)


def collision_behavior(request: wire.ForceTorqueCollisionBehavior) -> CollisionBehavior:
    """Return the thresholds; the nominal ones serve while accelerating if alone."""
    given = request.model_dump()
    chosen = {
        one.name: given.get(
            one.name, given[one.name.replace("acceleration", "nominal")]
        )
        for one in fields(CollisionBehavior)
    }
    return CollisionBehavior(**{name: tuple(v) for name, v in chosen.items()})


def fault(request: wire.Fault) -> SimulatedFault:
    """Return the fault to inject."""
    x, y, z = request.force
    kind = FaultKind(request.kind)
    return SimulatedFault(kind, request.cycles, request.joint, (x, y, z))


def grasp(request: wire.GripperGraspRequest) -> GraspRequest:
    """Return the width, the force and the tolerances of a grasp."""
    return GraspRequest(
        width=request.width,
        force=request.force,
        speed=request.speed,
        epsilon_inner=request.epsilon.inner,
        epsilon_outer=request.epsilon.outer,
    )
