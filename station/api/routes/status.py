"""The station at a glance: health, status, the loop, the joints and the hardware.

Hardware components also change their states here.
"""

import platform
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version

import station as package
from station.api import answers
from station.api.dependencies import Operator, ServicesDep, StationDep, Viewer
from station.api.errors import ProblemError
from station.api.routes.routing import ApiRouter, problems, routes_of
from station.core.control.hardware_components import ComponentState
from station.reports import HardwareComponentReport, LoopStatistics
from station.wire import (
    Hardware,
    HardwareComponents,
    HardwareComponentStateRequest,
    Health,
    JointStates,
    Ready,
    Recording,
    Status,
)

router = ApiRouter()
components = routes_of("robot", "/hardware/components")


@router.get("/health", tags=["health"], responses=problems(503))
async def health(station: StationDep) -> Health:
    """Answer while the process runs; 503 if its control loop died: restart the station.

    Raises:
        ProblemError: The control loop died.
    """
    reason = station.dead()
    if reason is not None:
        raise ProblemError(503, "loop_died", reason, "Restart the station.")
    return Health(boot_id=station.boot_id)


@router.get("/ready", tags=["health"], responses=problems(503))
async def ready(station: StationDep) -> Ready:
    """Answer while the loop runs with fresh cycles; otherwise 503 with the reason.

    Raises:
        ProblemError: The loop does not run, or its last cycle is old.
    """
    reason = station.ready()
    if reason is not None:
        raise ProblemError(
            503, "not_ready", reason, "See GET /api/v1/loop for what the loop does."
        )
    return Ready()


@lru_cache(maxsize=1)
def versions() -> dict[str, str]:
    """Return the versions of the station and of the packages that it uses."""
    found = {"station": package.__version__, "python": platform.python_version()}
    for name in ("mujoco", "numpy", "fastapi", "viser"):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return found


@router.get("/status", tags=["station"], dependencies=[Viewer], responses=problems())
def status(services: ServicesDep) -> Status:
    """Return robot mode, epoch, stop state, loop summary and versions."""
    lease = services.control.present()
    owner = None if lease is None else lease.owner
    log = services.event_recorder.log
    found = answers.status(services.station, versions(), log.state(), owner)
    recorder = services.recorder
    if recorder is None:
        return found
    last = recorder.last
    recording = None if last is None else Recording.model_validate(last)
    return found.model_copy(
        update={"recording": recording, "recorder_failure": recorder.failure or ""}
    )


@router.get(
    "/joint_states", tags=["robot"], dependencies=[Viewer], responses=problems(503)
)
async def joint_states(station: StationDep) -> JointStates:
    """Return positions, velocities and efforts of all joints in the same cycle."""
    return answers.joint_states(station.latest(), station.joint_names)


@router.get("/hardware", tags=["robot"], dependencies=[Viewer], responses=problems())
def hardware(station: StationDep) -> Hardware:
    """Return interfaces, claims, limits with their sources, transmissions, clamps."""
    return answers.hardware(station.hardware())


@router.get("/loop", tags=["loop"], dependencies=[Viewer], responses=problems())
def loop(station: StationDep) -> LoopStatistics:
    """Return rate, lateness, skipped cycles, and time per phase and per controller."""
    return station.loop_statistics()


@router.post(
    "/loop/statistics/reset",
    tags=["loop"],
    dependencies=[Viewer, Operator],
    responses=problems(503),
)
def reset_statistics(station: StationDep) -> LoopStatistics:
    """Reset the statistics of the loop and of the controllers."""
    station.reset_statistics()
    return station.loop_statistics()


@components.get("", responses=problems())
def list_hardware_components(station: StationDep) -> HardwareComponents:
    """List the hardware components with their states and interfaces."""
    return HardwareComponents(components=station.manager.hardware_components())


@components.put(
    "/{name}/state",
    dependencies=[Operator],
    responses=problems(404, 409, 413, 422, 503, 504),
)
def set_hardware_component_state(
    name: str, request: HardwareComponentStateRequest, station: StationDep
) -> HardwareComponentReport:
    """Bring a hardware component into a state of its life cycle.

    A component that controllers command leaves its active state only with
    `stop_controllers`, which stops these controllers first. A component that is not
    active offers no command interface, and a switch that needs one is refused.
    """
    return station.set_hardware_component_state(
        name,
        ComponentState(request.state),
        stop_controllers=request.stop_controllers,
    )
