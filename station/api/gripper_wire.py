"""From hands as the core describes them to the wire models, and back."""

from station import wire as schemas
from station.api.wire_numbers import measured
from station.core.franka import GraspRequest, GripperCommand, GripperState


def gripper(arm_id: str, found: GripperState) -> schemas.Gripper:
    """Return a gripper's state."""
    return schemas.Gripper(
        arm_id=arm_id,
        width=measured(found.width),
        max_width=found.max_width,
        is_grasped=found.is_grasped,
        temperature=found.temperature,
        time=found.time,
        activity=found.activity.value,
        force=measured(found.force),
        command=_command(found.command),
        last=_command(found.last),
    )


def grasp_request(request: schemas.GripperGraspRequest) -> GraspRequest:
    """Return what shall be grasped."""
    return GraspRequest(
        width=request.width,
        force=request.force,
        speed=request.speed,
        epsilon_inner=request.epsilon.inner,
        epsilon_outer=request.epsilon.outer,
    )


def _command(found: GripperCommand | None) -> schemas.GripperCommand | None:
    if found is None:
        return None
    return schemas.GripperCommand(
        id=str(found.identifier),
        action=found.action.value,
        status=found.status.value,  # type: ignore[arg-type]  # never pending
        message=found.message,
        request=dict(found.request),
        started=found.started,
        ended=found.ended,
    )
