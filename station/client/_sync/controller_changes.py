# Generated from _async/controller_changes.py by tools/generate_client.py.
"""Requests that load, unload and switch controllers, each with its patience and key."""

import math

from station import wire
from station.client._sync.connection import Connection
from station.client.routes import controller_path, keyed
from station.wire.controllers import LOAD_TIMEOUT


def load(
    connection: Connection, request: wire.LoadRequest, key: str | None
) -> wire.ControllerState:
    """Load a controller, and wait as long as loading may take.

    Args:
        connection: The client's connection.
        request: What to load.
        key: Name of the request, with which it is carried out once; None without one.
    """
    patience = request.timeout if "timeout" in request.model_fields_set else None
    return connection.send(
        "POST",
        "/controllers",
        wire.ControllerState,
        request,
        headers=keyed(key),
        patience=LOAD_TIMEOUT if patience is None else patience,
    )


def unload(connection: Connection, name: str, key: str | None) -> wire.ControllerState:
    """Unload a controller; return its last state.

    Args:
        connection: The client's connection.
        name: Its name.
        key: As for `load`.
    """
    path = controller_path(name)
    return connection.send("DELETE", path, wire.ControllerState, headers=keyed(key))


def switch(
    connection: Connection, request: wire.SwitchRequest, key: str | None
) -> wire.SwitchResult:
    """Start and stop controllers, and wait as long as the hardware may take.

    Args:
        connection: The client's connection.
        request: What to start and to stop.
        key: As for `load`.
    """
    bound = math.inf if request.bound is None else request.bound
    return connection.send(
        "POST",
        "/controllers/switch",
        wire.SwitchResult,
        request,
        headers=keyed(key),
        patience=request.timeout or bound,
    )
