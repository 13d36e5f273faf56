"""State of the station that the strip and the docks of the page show, as plain data."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass

from station.ui.link.station_view import StationView, choose_recovery, resources_of
from station.ui.page.controller_offers import (
    claims_text,
    command_units,
    example_parameters,
    offer_for,
    suggested_name,
)
from station.ui.teleoperation.commanded_controller import (
    CommandedController,
    choose_for_joints,
)
from station.wire import ControllerState, Status

_DEFAULT_KIND = "JointGroupPositionController"
_DEFAULT_TYPE = f"effort_controllers/{_DEFAULT_KIND}"
_MOST_NAMES = 3
"""Most claimed resources that a row names; for more, it shows their number."""
_JOINT_NUMBER = re.compile(r"_joint(\d+)$")
_STARTABLE = frozenset({"initialized", "stopped"})


@dataclass(frozen=True, slots=True)
class Enabling:
    """The action of the button "Enable sliders".

    Attributes:
        name: The controller to start; empty when there is nothing to enable.
        also: Further controllers to start with it, for the joints of other arms.
        replaces: Running controllers that stop at the same time.
        type: The type to load it from first; empty when it is loaded.
        parameters: Parameters to load it with, in YAML.
        reason: Why it cannot be done now; empty when it can.
    """

    name: str = ""
    also: tuple[str, ...] = ()
    replaces: tuple[str, ...] = ()
    type: str = ""
    parameters: str = ""
    reason: str = ""


def enabling(view: StationView) -> Enabling:
    """Return the controller to start so that joints take values, unless one runs.

    This is the first loaded group position controller, together with those of other
    joints, e.g. of a second arm. If none is loaded, a new one for all joints but the
    fingers is proposed.
    """
    if choose_for_joints(view)[0].name or view.status is None:
        return Enabling()
    default = _without_overlap(
        controller
        for controller in view.controllers
        if controller.type.endswith(_DEFAULT_KIND) and controller.state in _STARTABLE
    )
    # Both arms, or the person would have to enable the second one by hand.
    if default:
        replaces = (r for c in default for r in offer_for(view, c).replaces)
        return Enabling(
            default[0].name,
            tuple(controller.name for controller in default[1:]),
            tuple(dict.fromkeys(replaces)),
            reason=_trouble(view) or view.blocked(),
        )
    if not any(known.type == _DEFAULT_TYPE for known in view.types):
        return Enabling()
    taken = (controller.name for controller in view.controllers)
    return Enabling(
        suggested_name(_DEFAULT_TYPE, taken),
        type=_DEFAULT_TYPE,
        parameters=example_parameters(_DEFAULT_TYPE, view.positions),
        reason=_trouble(view) or view.blocked(),
    )


def page_state(view: StationView) -> dict[str, object]:
    """Return the state of the docks, ready for JSON."""
    operated = choose_for_joints(view)
    status = view.status
    return {
        "link": view.link,
        "boot_id": "" if status is None else status.boot_id,
        "operated": {
            "names": [one.name for one in operated if one.name],
            "reason": operated[0].reason or _unknown_start(view, operated),
            "elements": [e.model_dump() for one in operated for e in one.elements],
        },
        "enabling": asdict(enabling(view)),
        "rescue": asdict(choose_recovery(view)),
        "controllers": [_row(view, c) for c in view.controllers],
        "types": [known.type for known in view.types],
        "arms": [] if status is None else [a.model_dump() for a in status.robots],
        "simulation": (
            asdict(status.simulation)
            if status is not None and status.simulation is not None
            else None
        ),
        "limits": {name: list(ends) for name, ends in view.limits.items()},
        "sliding": sorted(view.sliding),
        "joints": [name for name in view.positions if "finger" not in name],
    }


def _unknown_start(view: StationView, operated: Iterable[CommandedController]) -> str:
    """Return a sentence while a set-point is not known; joints cannot move then."""
    unknown = (
        one.name
        for one in operated
        if one.name and view.set_point_of(one.name, len(one.elements)) is None
    )
    name = next(unknown, "")
    return f"Waiting for the first set-point of {name}." if name else ""


def _without_overlap(controllers: Iterable[ControllerState]) -> list[ControllerState]:
    """Return controllers that can run together; the first ones are preferred."""
    chosen: list[ControllerState] = []
    taken: set[str] = set()
    for controller in controllers:
        wanted = resources_of(controller)
        if not wanted & taken:
            chosen.append(controller)
            taken |= wanted
    return chosen


def _trouble(view: StationView) -> str:
    return "Recover the arm first." if choose_recovery(view).trouble else ""


def _short_claims(controller: ControllerState, arms: Sequence[str]) -> list[str]:
    """Return each claim in one or two words, e.g. `effort 1-7`."""
    parts = []
    for claim in controller.claimed_resources:
        kind = claim.hardware_interface.rpartition("::")[2].removesuffix("Interface")
        kind = kind.removeprefix("Franka").removesuffix("Joint")
        kind = kind.removesuffix("Cartesian").lower()
        numbers = [name[-1] for name in claim.resources if name[-1:].isdigit()]
        stems = {name[:-1] for name in claim.resources}
        if len(stems) == 1 and len(numbers) == len(claim.resources) > 1:
            parts.append(f"{kind} {numbers[0]}-{numbers[-1]}")
        elif len(claim.resources) > _MOST_NAMES:
            parts.append(f"{kind}, {len(claim.resources)} joints")
        elif claim.resources:
            prefixes = [f"{arm}_" for arm in arms if len(arms) == 1]
            names = (
                _JOINT_NUMBER.sub(r" \1", _without(name, prefixes))
                for name in claim.resources
            )
            parts.append(f"{kind} {', '.join(names)}")
    return parts or ["nothing"]


def _without(name: str, prefixes: Sequence[str]) -> str:
    for prefix in prefixes:
        name = name.removeprefix(prefix)
    return name


def _row(view: StationView, controller: ControllerState) -> dict[str, object]:
    offer = offer_for(view, controller)
    return {
        "name": controller.name,
        "type": controller.type,
        "state": controller.state,
        "fault": controller.fault,
        "claims": claims_text(controller),
        "claims_short": _short_claims(
            controller,
            [] if view.status is None else [a.arm_id for a in view.status.robots],
        ),
        "resources": sorted(resources_of(controller)),
        "arms": list(view.arms_of(controller)),
        "command_units": command_units(controller, view.sliding),
        "update_p50": controller.time.p50,
        "update_p99": controller.time.p99,
        "update_count": controller.time.count,
        "replaces": list(offer.replaces),
        "reason": offer.reason,
    }


@dataclass(frozen=True, slots=True)
class BarState:
    """The content of the status strip.

    Attributes:
        link: `live`, `stale` (data too old to trust) or `lost` (no answer).
        age: How old the newest data is [s]; None before the first.
        robot: `SIMULATION` or `REAL ARM` with its address; empty while unknown.
        mode: The robot's mode, and its errors if it has some.
        stop_state: `armed`, `stopped` or `released`; empty while unknown.
        stop_reason: Why the stop was engaged last.
        rate_hz: Measured rate of the control loop [Hz].
        lateness_p99: p99 of the lateness of the cycles [s].
        real_time_factor: Station time over wall time, as measured; None while unknown.
        paused: Whether simulated time stands still.
        epoch: Changes at each stop, reset and recovery.
        message: The last refusal or failure, in the words of the station.
        refused: The last refusal of Viser's panel or of a pull while it is recent.
    """

    link: str
    age: float | None = None
    robot: str = ""
    mode: str = ""
    stop_state: str = ""
    stop_reason: str = ""
    rate_hz: float | None = None
    lateness_p99: float | None = None
    real_time_factor: float | None = None
    paused: bool = False
    epoch: int | None = None
    message: str = ""
    refused: str = ""


def bar_state(view: StationView, message: str) -> BarState:
    """Return the content of the status strip.

    Args:
        view: The dashboard's knowledge of the station.
        message: The last refusal; the reason of a broken link takes its place when
            there is none.
    """
    refused, message = message, message or view.failure
    status = view.status
    if status is None:
        return BarState(view.link, view.age, message=message, refused=refused)
    return BarState(
        link=view.link,
        age=view.age,
        robot=status.robot_label,
        mode=_mode(status),
        stop_state=status.stop_state,
        stop_reason=status.stop_reason,
        rate_hz=status.loop.achieved_rate,
        lateness_p99=status.loop.lateness.p99,
        real_time_factor=status.loop.achieved_real_time_factor,
        paused=status.simulation is not None and status.simulation.paused,
        epoch=status.epoch,
        message=message,
        refused=refused,
    )


def _mode(status: Status) -> str:
    """Return the robot's mode, with errors and remedies when an arm is halted."""
    wrong = []
    for arm in status.robots:
        if arm.remedy:
            names = ", ".join(dict.fromkeys(error.name for error in arm.errors))
            remedy = arm.remedy.partition(" (")[0]  # here is a button instead
            wrong.append(f"{arm.arm_id}: {names or arm.robot_mode}: {remedy}")
    paused = status.simulation is not None and status.simulation.paused
    mode = f"{status.robot_mode}, paused" if paused else status.robot_mode
    return " · ".join([mode, *wrong])
