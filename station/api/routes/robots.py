"""Arms: state, model, the services of franka_control, and what simulations can do."""

from fastapi import APIRouter

from station import wire
from station.api import answers, requests
from station.api.dependencies import Operator, StationDep, Viewer
from station.api.json_route import JsonRoute
from station.api.routes.problems import problems
from station.core.facade.station import Station
from station.core.franka import Frame

router = APIRouter(
    prefix="/robots", tags=["robots"], dependencies=[Viewer], route_class=JsonRoute
)
_READ = problems(404, 503)
_WRITE = problems(404, 409, 413, 422, 503)


def _report(station: Station, arm_id: str) -> wire.ArmReport:
    return answers.arm_report(station.robots.report(arm_id))


@router.get("", responses=problems())
def list_robots(station: StationDep) -> wire.Arms:
    """List the arms, their modes and errors, and what to do about these."""
    return wire.Arms(robots=answers.arms(station))


@router.post(
    "/error_recovery",
    dependencies=[Operator],
    responses=problems(409, 413, 422, 423, 503, 504),
)
def recover_all(
    station: StationDep, request: wire.RecoveryRequest | None = None
) -> wire.Recoveries:
    """Clear the errors of all arms, or of none if one of them cannot recover.

    Nothing happens when no arm has an error.
    """
    restart = request is not None and request.restart == "previous"
    restarted = station.robots.recover_all(restart=restart)
    return wire.Recoveries.model_validate({
        "robots": answers.arms(station),
        "restarted": restarted,
    })


@router.get("/{arm_id}/state", responses=_READ)
def get_state(arm_id: str, station: StationDep) -> wire.FrankaState:
    """Return the arm's whole state."""
    return answers.franka_state(station.robots.state(arm_id))


@router.get("/{arm_id}/model", responses=problems(404, 422, 503))
def get_model(
    arm_id: str, station: StationDep, frame: wire.FrameName = "end_effector"
) -> wire.ArmModel:
    """Return mass, Coriolis, gravity, and a frame's pose and Jacobians."""
    found = station.robots.model(arm_id, Frame[frame.upper()])
    return wire.ArmModel.model_validate(found)


@router.get("/{arm_id}/errors", responses=_READ)
def get_errors(arm_id: str, station: StationDep) -> wire.ArmReport:
    """Return the arm's mode and errors, and what to do."""
    return _report(station, arm_id)


@router.get("/{arm_id}/log", responses=_READ)
def get_log(arm_id: str, station: StationDep) -> wire.ArmLog:
    """Return the last cycles of the motion before the last error."""
    return wire.ArmLog.model_validate({"records": station.robots.log(arm_id)})


@router.put("/{arm_id}/joint_impedance", dependencies=[Operator], responses=_WRITE)
def set_joint_impedance(
    arm_id: str, request: wire.JointImpedance, station: StationDep
) -> wire.ArmReport:
    """Set the internal joint impedance; refused while the arm moves."""
    station.robots.set_joint_impedance(arm_id, request.joint_stiffness)
    return _report(station, arm_id)


@router.put("/{arm_id}/cartesian_impedance", dependencies=[Operator], responses=_WRITE)
def set_cartesian_impedance(
    arm_id: str, request: wire.CartesianImpedance, station: StationDep
) -> wire.ArmReport:
    """Set the internal Cartesian impedance; refused while the arm moves."""
    station.robots.set_cartesian_impedance(arm_id, request.cartesian_stiffness)
    return _report(station, arm_id)


@router.put("/{arm_id}/ee_frame", dependencies=[Operator], responses=_WRITE)
def set_ee_frame(
    arm_id: str, request: wire.EndEffectorFrame, station: StationDep
) -> wire.ArmReport:
    """Set the end effector frame; refused while the arm moves."""
    station.robots.set_EE_frame(arm_id, request.NE_T_EE)
    return _report(station, arm_id)


@router.put("/{arm_id}/k_frame", dependencies=[Operator], responses=_WRITE)
def set_k_frame(
    arm_id: str, request: wire.StiffnessFrame, station: StationDep
) -> wire.ArmReport:
    """Set the stiffness frame; refused while the arm moves."""
    station.robots.set_K_frame(arm_id, request.EE_T_K)
    return _report(station, arm_id)


@router.put("/{arm_id}/load", dependencies=[Operator], responses=_WRITE)
def set_load(arm_id: str, request: wire.Load, station: StationDep) -> wire.ArmReport:
    """Set what the hand holds; refused while the arm moves."""
    station.robots.set_load(
        arm_id, request.mass, request.F_x_center_load, request.load_inertia
    )
    return _report(station, arm_id)


@router.put(
    "/{arm_id}/force_torque_collision_behavior",
    dependencies=[Operator],
    responses=_WRITE,
)
def set_force_torque_collision_behavior(
    arm_id: str, request: wire.ForceTorqueCollisionBehavior, station: StationDep
) -> wire.ArmReport:
    """Set the thresholds of every phase; refused while the arm moves."""
    behavior = requests.collision_behavior(request)
    station.robots.set_collision_behavior(arm_id, behavior)
    return _report(station, arm_id)


@router.put(
    "/{arm_id}/full_collision_behavior", dependencies=[Operator], responses=_WRITE
)
def set_full_collision_behavior(
    arm_id: str, request: wire.FullCollisionBehavior, station: StationDep
) -> wire.ArmReport:
    """Set the thresholds of both phases; refused while the arm moves."""
    behavior = requests.collision_behavior(request)
    station.robots.set_collision_behavior(arm_id, behavior)
    return _report(station, arm_id)


@router.post(
    "/{arm_id}/error_recovery",
    dependencies=[Operator],
    responses=problems(404, 409, 413, 422, 423, 503, 504),
)
def error_recovery(
    arm_id: str, station: StationDep, request: wire.RecoveryRequest | None = None
) -> wire.Recovery:
    """Clear the errors; controllers stay stopped unless asked for.

    Every command and goal from before is void. Nothing happens when there is no error.
    """
    restart = request is not None and request.restart == "previous"
    restarted = station.robots.recover(arm_id, restart=restart)
    report = _report(station, arm_id)
    return wire.Recovery(**dict(report), restarted=list(restarted))


@router.post("/{arm_id}/user_stop", dependencies=[Operator], responses=_WRITE)
def user_stop(
    arm_id: str, request: wire.UserStopRequest, station: StationDep
) -> wire.ArmReport:
    """Press or release the user stop of a simulated arm."""
    station.robots.set_user_stop(arm_id, pressed=request.pressed)
    return _report(station, arm_id)


@router.post("/{arm_id}/guiding", dependencies=[Operator], responses=_WRITE)
def guiding(
    arm_id: str, request: wire.GuidingRequest, station: StationDep
) -> wire.ArmReport:
    """Hold or let go of the guiding buttons of a simulated arm that is idle."""
    station.robots.set_guiding(arm_id, pressed=request.pressed)
    return _report(station, arm_id)


@router.post("/{arm_id}/connect", dependencies=[Operator], responses=_WRITE)
def connect(arm_id: str, station: StationDep) -> wire.ArmReport:
    """Connect to the arm; refused when it is connected."""
    station.robots.connect(arm_id)
    return _report(station, arm_id)


@router.post("/{arm_id}/disconnect", dependencies=[Operator], responses=_WRITE)
def disconnect(arm_id: str, station: StationDep) -> wire.ArmReport:
    """Give the arm up; refused while a controller commands it."""
    station.robots.disconnect(arm_id)
    return _report(station, arm_id)


@router.post("/{arm_id}/external_force", dependencies=[Operator], responses=_WRITE)
def external_force(
    arm_id: str, request: wire.ExternalForce, station: StationDep
) -> wire.ArmReport:
    """Push a link, as a human would; in simulation only."""
    station.robots.apply_force(
        arm_id,
        request.link,
        request.force,
        request.torque,
        request.duration,
        frame=request.frame,
        point=request.point,
    )
    return _report(station, arm_id)


@router.post("/{arm_id}/faults", dependencies=[Operator], responses=_WRITE)
def inject_fault(
    arm_id: str, request: wire.Fault, station: StationDep
) -> wire.ArmReport:
    """Make something go wrong; in simulation only."""
    station.robots.inject(arm_id, requests.fault(request))
    return _report(station, arm_id)


@router.get("/{arm_id}/faults", responses=problems(404, 409, 503))
def get_faults(arm_id: str, station: StationDep) -> wire.Faults:
    """Return what was made to go wrong and lasts; in simulation only."""
    return _faults(station, arm_id)


@router.delete(
    "/{arm_id}/faults", dependencies=[Operator], responses=problems(404, 409, 503)
)
def clear_faults(arm_id: str, station: StationDep) -> wire.Faults:
    """End what was made to go wrong, and every push; in simulation only."""
    station.robots.clear_faults(arm_id)
    return _faults(station, arm_id)


def _faults(station: Station, arm_id: str) -> wire.Faults:
    return wire.Faults.model_validate({"faults": station.robots.faults(arm_id)})
