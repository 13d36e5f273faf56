"""Make the routes of declared services from their declarations.

A service of the station itself has a wire model, which the client shares. For every
other service the request model is made from the parameters of its method.
"""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from inspect import Parameter
from typing import Annotated, Any

from fastapi import APIRouter, Body
from pydantic import BaseModel, create_model

from station import wire
from station.api.dependencies import Operator, StationDep
from station.api.routes.routing import problems, routes_of
from station.core.errors import HardwareInterfaceError
from station.core.facade.station import Station
from station.core.hardware.services import RobotServices, Service, ServiceKind

METHODS = {
    ServiceKind.QUERY: "GET",
    ServiceKind.SETTING: "PUT",
    ServiceKind.ACTION: "POST",
}
Answer = Callable[[Station, str, object], Any]
"""Function that makes the answer from the station, the robot's name and the returned
value."""


def add_service(
    router: APIRouter,
    service: Service,
    request: type[BaseModel] | None,
    reply: Any,  # noqa: ANN401 - a model, or the annotation of the method
    answer: Answer,
    operation: str = "",
) -> None:
    """Add the route of a service below `/{arm_id}`.

    Args:
        router: Router that gets the route; its routes need the viewer role.
        service: The service.
        request: Model of the body; None for a service without parameters.
        reply: Model of the answer.
        answer: Makes the answer.
        operation: Name of the operation in the OpenAPI document; empty for the
            service's name.
    """
    changes = service.kind is not ServiceKind.QUERY
    refusals = (404, 409, 413, 422) if changes else (404, 409)
    stopped = (423,) if service.moves else ()
    router.add_api_route(
        f"/{{arm_id}}/{service.path}",
        _endpoint(service, request, answer),
        methods=[METHODS[service.kind]],
        name=operation or service.name.lower(),
        description=service.description,
        dependencies=[Operator] if changes else [],
        response_model=reply,
        responses=problems(*refusals, *stopped, 503),
    )


def _endpoint(
    service: Service, request: type[BaseModel] | None, answer: Answer
) -> Callable[..., Any]:
    def call(arm_id: str, station: StationDep) -> object:
        return answer(station, arm_id, call_service(station, arm_id, service.name, {}))

    def call_with(
        arm_id: str,
        station: StationDep,
        request: Annotated[request, Body()],  # type: ignore[valid-type]  # made above
    ) -> object:
        arguments = {name: getattr(request, name) for name in service.parameters}
        returned = call_service(station, arm_id, service.name, arguments)
        return answer(station, arm_id, returned)

    return call if request is None else call_with


def call_service(
    station: Station, arm_id: str, name: str, arguments: Mapping[str, object]
) -> object:
    """Call a declared service between two cycles; return the value of its method.

    Args:
        station: The station.
        arm_id: The robot.
        name: The service.
        arguments: Its arguments by name.

    Raises:
        StationError: The service is unknown, or refuses; nothing has changed.
    """
    declared, method = station.robots.find_service(arm_id, name)
    return station.loop.run_in_cycle(partial(method, **arguments), moves=declared.moves)


def request_model(service: Service) -> type[BaseModel] | None:
    """Return a model with the parameters of a service; None without parameters."""
    if not service.parameters:
        return None
    fields: dict[str, Any] = {
        name: (p.annotation, ... if p.default is Parameter.empty else p.default)
        for name, p in service.parameters.items()
    }
    name = "".join(word.capitalize() for word in service.name.split("_"))
    return create_model(f"{name}Request", __base__=wire.RequestModel, **fields)


def services_of(kinds: Iterable[type[RobotServices]], taken: set[str]) -> APIRouter:
    """Return the routes of all services that these classes declare.

    Args:
        kinds: Classes of robots' services.
        taken: Paths of services that already have a route.

    Raises:
        HardwareInterfaceError: Two services, or a service and a route of the station,
            have the same path.
    """
    router = routes_of("robots", "/robots")
    for kind in kinds:
        for service in kind.services().values():
            if service.path in taken:
                raise HardwareInterfaceError(
                    f"Service '{service.name}' of {kind.__name__} has the path "
                    f"'{service.path}', which is taken.",
                    remedy="Give the method another name.",
                )
            taken = {*taken, service.path}
            model = request_model(service)
            # The prefix avoids the names of the station's own operations.
            name = f"call_{service.path}"
            add_service(router, service, model, service.returns, _returned, name)
    return router


def _returned(_: Station, __: str, returned: object) -> object:
    return returned


def describe(station: Station, name: str) -> wire.Services:
    """Return the declared services of a robot.

    Raises:
        ArmNotFoundError: The robot is unknown.
    """
    return wire.Services(
        services=[
            wire.ServiceInfo(
                name=service.name,
                method=METHODS[service.kind],
                path=service.path,
                description=service.description,
                parameters=list(service.parameters),
            )
            for service in station.robots.services(name).values()
        ]
    )
