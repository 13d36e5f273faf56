"""Hardware components: their states, and changes of these states."""

from station.api.dependencies import Operator, StationDep
from station.api.routes.routing import problems, routes_of
from station.core.control.hardware_components import ComponentState
from station.reports import HardwareComponentReport
from station.wire import HardwareComponents, HardwareComponentStateRequest

router = routes_of("robot", "/hardware/components")


@router.get("", responses=problems())
def list_hardware_components(station: StationDep) -> HardwareComponents:
    """List the hardware components with their states and interfaces."""
    return HardwareComponents(components=station.manager.hardware_components())


@router.put(
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
