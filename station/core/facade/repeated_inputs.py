"""Carry out inputs that are given as data, by a recording or for a rehearsal.

An input has a `kind` and the arguments that `InputLog` notes with it.
"""

from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

from station.core.control.hardware_components import ComponentState
from station.core.control.switching import Strictness, SwitchRequest
from station.core.facade.station import Station
from station.core.ports.command_ticket import CommandTicket

Arguments: TypeAlias = Mapping[str, Any]
"""The arguments of an input, as JSON-compatible values."""


def carry_out(station: Station, kind: str, one: Arguments) -> bool:
    """Carry out an input that takes effect before the next cycle.

    Args:
        station: The station.
        kind: Kind of the input.
        one: Its arguments.

    Returns:
        Whether inputs of this kind can be carried out.

    Raises:
        StationError: The station refuses the input; nothing changed.
    """
    act = _ACT.get(kind)
    if act is None:
        return False
    act(station, one)
    return True


def carry_out_plan(
    station: Station, kind: str, one: Arguments, ticket: CommandTicket | None = None
) -> bool:
    """Carry out an input that is planned first and taken up by a later cycle.

    Args:
        station: The station.
        kind: Kind of the input.
        one: Its arguments.
        ticket: Notes the cycle that takes the plan.

    Returns:
        Whether inputs of this kind are planned.

    Raises:
        StationError: The station refuses the input; nothing changed.
    """
    if kind == "goal":
        station.motion.submit_goal(one["name"], one["request"], ticket=ticket)
    elif kind == "trajectory":
        station.motion.follow_trajectory(one["name"], one["request"], ticket=ticket)
    else:
        return False
    return True


def _switch(station: Station, one: Arguments) -> None:
    station.switch_controllers(
        SwitchRequest(
            one["start"],
            one["stop"],
            Strictness(one.get("strictness", Strictness.STRICT.value)),
            start_asap=one.get("start_asap", False),
            timeout=one.get("timeout", 0.0),
            zero_period=one.get("zero_period", False),
        )
    )


def _set_point(station: Station, one: Arguments) -> None:
    station.motion.set_command(
        one["name"], one["values"], timeout=one["timeout"], rates=one["rates"]
    )


def _expire(station: Station, one: Arguments) -> None:
    port = station.manager.get_controller(one["name"]).set_points
    if port is not None:
        port.expire()


def _cancel_goal(station: Station, one: Arguments) -> None:
    goals = station.motion.goals(one["name"])
    station.motion.cancel_goal(one["name"], goals[-1 - one["behind"]].identifier)


def _service(station: Station, one: Arguments) -> None:
    declared, method = station.robots.find_service(one["robot"], one["service"])
    station.loop.run_in_cycle(lambda: method(**one["arguments"]), moves=declared.moves)


def _hardware(station: Station, one: Arguments) -> None:
    # The controllers that it stopped before have an input `switch` of their own.
    station.set_hardware_component_state(one["name"], ComponentState(one["state"]))


def _recover(station: Station, one: Arguments) -> None:
    for name in one["robots"]:
        station.robots.recover(name)


_ACT: dict[str, Callable[[Station, Arguments], object]] = {
    "switch": _switch,
    "set_point": _set_point,
    "expire": _expire,
    "cancel_goal": _cancel_goal,
    "hold_trajectory": lambda station, one: station.motion.hold(one["name"]),
    "gains": lambda station, one: station.tuning.set_many(one["changes"]),
    "stop": lambda station, one: station.stop(one["reason"]),
    "release": lambda station, one: station.release_stop(arm=one["arm"]),
    "reset": lambda station, one: station.simulation.reset(one["positions"]),
    "load": lambda station, one: station.load_controller(
        one["name"], params=one["params"]
    ),
    "unload": lambda station, one: station.unload_controller(one["name"]),
    "hardware": _hardware,
    "service": _service,
    "recover": _recover,
    "scene": lambda station, one: station.surroundings.repeat(
        one["changed"], one["removed"], one["placed"]
    ),
    "late": lambda station, one: station.loop.delay_next_cycle(one["periods"] - 1),
}
"""The function that carries out each kind of input."""
PLANNED = frozenset({"goal", "trajectory"})
"""The kinds of inputs that are planned first and handed over later."""
