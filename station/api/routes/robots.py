"""Arms and grippers: state, model, services, and buttons and faults in simulation."""

from collections.abc import Mapping, Sequence
from dataclasses import fields

from fastapi import APIRouter

from station import wire
from station.api import answers
from station.api.dependencies import ArmsDep, GrippersDep, StationDep
from station.api.routes.routing import change, problems, routes_of
from station.api.service_routes import add_service, describe, services_of
from station.core.facade.station import Station
from station.core.franka import (
    CollisionBehavior,
    FaultKind,
    Frame,
    FrankaServices,
    GraspRequest,
    GripperServices,
    SimulatedFault,
)
from station.core.franka.arms import Arms
from station.wire.protocol import PREFIX

router = routes_of("robots", "/robots")
_READ = problems(404, 503)
_WRITE = change(404, 409, 413, 422, 503)


def _report(arms: Arms, arm_id: str) -> wire.ArmReport:
    return answers.arm_report(arms.report(arm_id))


@router.get("", responses=problems())
def list_robots(station: StationDep) -> wire.Arms:
    """List the arms with their modes, errors and remedies."""
    return wire.Arms(robots=answers.arms(station))


def _restart(request: wire.RecoveryRequest | None) -> bool | list[str]:
    asked = "none" if request is None else request.restart
    return asked if isinstance(asked, list) else asked == "previous"


@router.post("/error_recovery", **change(404, 409, 413, 422, 423, 503, 504))
def recover_all(
    station: StationDep, request: wire.RecoveryRequest | None = None
) -> wire.Recoveries:
    """Clear the errors of all arms, or of none if an arm cannot recover.

    Nothing happens if no arm has an error.
    """
    restarted = station.robots.recover_all(restart=_restart(request))
    return wire.Recoveries.model_validate({
        "robots": answers.arms(station),
        "restarted": restarted,
    })


@router.get("/{arm_id}/services", responses=problems(404))
def list_services(arm_id: str, station: StationDep) -> wire.Services:
    """List the robot's services: method, path, parameters and description of each."""
    return describe(station, arm_id)


@router.get("/{arm_id}/state", responses=_READ)
def get_arm_state(arm_id: str, arms: ArmsDep, station: StationDep) -> wire.FrankaState:
    """Return the arm's whole state."""
    nearest = station.surroundings.clearance(arm_id)
    values = answers.franka_state(arms.state(arm_id), nearest)
    return wire.FrankaState.model_validate(values)


@router.get("/{arm_id}/model", responses=problems(404, 422, 503))
def get_arm_model(
    arm_id: str, arms: ArmsDep, frame: wire.FrameName = "end_effector"
) -> wire.ArmModel:
    """Return mass, Coriolis, gravity, and a frame's pose and Jacobians."""
    found = arms.model(arm_id, Frame[frame.upper()])
    return wire.ArmModel.model_validate(found)


@router.get("/{arm_id}/errors", responses=_READ)
def get_arm_errors(arm_id: str, arms: ArmsDep) -> wire.ArmReport:
    """Return the arm's mode, errors and remedy."""
    return _report(arms, arm_id)


@router.get("/{arm_id}/log", responses=_READ)
def get_arm_log(arm_id: str, arms: ArmsDep) -> wire.ArmLog:
    """Return the last cycles of the motion before the last error."""
    return wire.ArmLog.model_validate({"records": arms.log(arm_id)})


def _report_after(station: Station, arm_id: str, _: object) -> wire.ArmReport:
    return _report(Arms(station.robots), arm_id)


def declared(station: Station) -> APIRouter:
    """Return the routes of the services that a user's robot declares."""
    own = (FrankaServices, GripperServices)
    kinds = [kind for kind in station.robots.kinds() if not issubclass(kind, own)]
    return services_of(kinds, {_service_path(route) for route in router.routes})


def _service_path(route: object) -> str:
    path: str = getattr(route, "path", "")
    return path.removeprefix(PREFIX + "/robots/{arm_id}/")


_SERVICES = FrankaServices.services()
for _name, _request in (
    ("set_joint_impedance", wire.JointImpedance),
    ("set_cartesian_impedance", wire.CartesianImpedance),
    ("set_EE_frame", wire.EndEffectorFrame),
    ("set_K_frame", wire.StiffnessFrame),
    ("set_load", wire.Load),
    ("connect", None),
    ("disconnect", None),
):
    add_service(router, _SERVICES[_name], _request, wire.ArmReport, _report_after)
add_service(
    router,
    _SERVICES["contact_budget"],
    None,
    wire.ContactBudget,
    lambda _, __, returned: returned,
)


@router.put("/{arm_id}/force_torque_collision_behavior", **_WRITE)
def set_force_torque_collision_behavior(
    arm_id: str, request: wire.ForceTorqueCollisionBehavior, arms: ArmsDep
) -> wire.ArmReport:
    """Set the thresholds of all phases of a motion; refused while the arm moves."""
    arms.set_collision_behavior(arm_id, collision_thresholds(request.model_dump()))
    return _report(arms, arm_id)


@router.put("/{arm_id}/full_collision_behavior", **_WRITE)
def set_full_collision_behavior(
    arm_id: str, request: wire.FullCollisionBehavior, arms: ArmsDep
) -> wire.ArmReport:
    """Set separate thresholds for accelerating; refused while the arm moves."""
    arms.set_collision_behavior(arm_id, collision_thresholds(request.model_dump()))
    return _report(arms, arm_id)


@router.post("/{arm_id}/error_recovery", **change(404, 409, 413, 422, 423, 503, 504))
def error_recovery(
    arm_id: str, station: StationDep, request: wire.RecoveryRequest | None = None
) -> wire.Recovery:
    """Clear the errors; controllers stay stopped unless `restart` starts them.

    All earlier commands and goals become void. Nothing happens without an error.
    """
    restarted = station.robots.recover(arm_id, restart=_restart(request))
    report = _report(Arms(station.robots), arm_id)
    return wire.Recovery(**dict(report), restarted=list(restarted))


@router.post("/{arm_id}/user_stop", **_WRITE)
def user_stop(
    arm_id: str, request: wire.UserStopRequest, arms: ArmsDep
) -> wire.ArmReport:
    """Press or release the user stop of a simulated arm."""
    arms.set_user_stop(arm_id, pressed=request.pressed)
    return _report(arms, arm_id)


@router.post("/{arm_id}/guiding", **_WRITE)
def guiding(arm_id: str, request: wire.GuidingRequest, arms: ArmsDep) -> wire.ArmReport:
    """Press or release the guiding buttons of a simulated arm that is idle."""
    arms.set_guiding(arm_id, pressed=request.pressed)
    return _report(arms, arm_id)


@router.post("/{arm_id}/external_force", **_WRITE)
def external_force(
    arm_id: str, request: wire.ExternalForce, arms: ArmsDep
) -> wire.ArmReport:
    """Push a link of the arm or another object; in simulation only."""
    arms.apply_force(
        arm_id,
        request.link,
        request.force,
        request.torque,
        request.duration,
        frame=request.frame,
        point=request.point,
    )
    return _report(arms, arm_id)


@router.post("/{arm_id}/faults", **_WRITE)
def inject_fault(arm_id: str, request: wire.Fault, arms: ArmsDep) -> wire.ArmReport:
    """Inject a fault; in simulation only."""
    arms.inject(arm_id, fault_of(request))
    return _report(arms, arm_id)


@router.get("/{arm_id}/faults", responses=problems(404, 409, 503))
def get_faults(arm_id: str, arms: ArmsDep) -> wire.Faults:
    """Return the faults that are active; in simulation only."""
    return _faults(arms, arm_id)


@router.delete("/{arm_id}/faults", **change(404, 409, 503))
def clear_faults(arm_id: str, arms: ArmsDep) -> wire.Faults:
    """End all faults and all pushes; in simulation only."""
    arms.clear_faults(arm_id)
    return _faults(arms, arm_id)


def _faults(arms: Arms, arm_id: str) -> wire.Faults:
    return wire.Faults.model_validate({"faults": arms.faults(arm_id)})


@router.get("/{arm_id}/gripper", responses=problems(404, 503))
def get_gripper(arm_id: str, grippers: GrippersDep) -> wire.Gripper:
    """Return the gripper's state: its activity, and how the last command ended."""
    return answers.gripper(arm_id, grippers.state(arm_id))


@router.post("/{arm_id}/gripper/homing", status_code=202, **_WRITE)
def home_gripper(arm_id: str, grippers: GrippersDep) -> wire.Gripper:
    """Begin to close and to open the gripper completely; answer at once."""
    return answers.gripper(arm_id, grippers.homing(arm_id))


@router.post("/{arm_id}/gripper/move", status_code=202, **_WRITE)
def move_gripper(
    arm_id: str, request: wire.GripperMoveRequest, grippers: GrippersDep
) -> wire.Gripper:
    """Begin to open or close the gripper to a width; answer at once.

    Like every command of a gripper, it ends the previous one.
    """
    found = grippers.move(arm_id, request.width, request.speed)
    return answers.gripper(arm_id, found)


@router.post("/{arm_id}/gripper/grasp", status_code=202, **_WRITE)
def grasp(
    arm_id: str, request: wire.GripperGraspRequest, grippers: GrippersDep
) -> wire.Gripper:
    """Begin to grasp an object; answer at once.

    The fingers close, or open if they are closer than the width, until an object stops
    them. If the object has the expected width, the fingers press it with the force.
    """
    found = grippers.grasp(arm_id, grasp_request(request))
    return answers.gripper(arm_id, found)


@router.post("/{arm_id}/gripper/stop", **change(404, 413, 422, 503))
def stop_gripper(arm_id: str, grippers: GrippersDep) -> wire.Gripper:
    """Hold the fingers still without force; a grasped object can fall.

    This is possible at any time, also while the station is stopped.
    """
    return answers.gripper(arm_id, grippers.stop(arm_id))


def collision_thresholds(given: Mapping[str, Sequence[float]]) -> CollisionBehavior:
    """Return the thresholds; those for accelerating are the nominal ones by default.

    Args:
        given: The fields of a request, by name.
    """
    chosen = {
        one.name: given.get(
            one.name, given[one.name.replace("acceleration", "nominal")]
        )
        for one in fields(CollisionBehavior)
    }
    return CollisionBehavior(**{name: tuple(v) for name, v in chosen.items()})


def fault_of(request: wire.Fault) -> SimulatedFault:
    """Return the fault to inject."""
    x, y, z = request.force
    kind = FaultKind(request.kind)
    return SimulatedFault(kind, request.cycles, request.joint, (x, y, z))


def grasp_request(request: wire.GripperGraspRequest) -> GraspRequest:
    """Return the width, the force and the tolerances of a grasp."""
    return GraspRequest(
        width=request.width,
        force=request.force,
        speed=request.speed,
        epsilon_inner=request.epsilon.inner,
        epsilon_outer=request.epsilon.outer,
    )
