"""Calls of declared services, as the API makes them."""

from functools import partial

from station.core.facade.station import Station


def call_service(
    station: Station, robot: str, name: str, **arguments: object
) -> object:
    """Call a declared service of a robot between two cycles."""
    service, method = station.robots.find_service(robot, name)
    return station.loop.run_in_cycle(partial(method, **arguments), moves=service.moves)
