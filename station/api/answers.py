"""Make the answers whose structure differs from the core's values.

All other answers are reports that are sent as they are, or models that pydantic reads
from the core's values.
"""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, fields

from pydantic import JsonValue

from station import wire
from station.core.control import tunables
from station.core.control.controller import ControllerSample
from station.core.control.switching import SwitchResult
from station.core.facade.station import HardwareReport, Station
from station.core.franka import GripperState, RobotMode, RobotState
from station.core.franka.arms import ArmReport, Arms
from station.core.franka.franka_errors import error_names
from station.core.hardware.robot_report import ClampReport, JointLimitsReport
from station.core.loop.snapshot import Snapshot
from station.core.ports.goal import Goal, GoalStatus
from station.core.ports.set_point import SetPoint
from station.core.trajectory import PosVelAccState
from station.events import Alarm, EventLogState
from station.reports import Clearance
from station.wire.base import finite_or_none


def controllers(station: Station) -> wire.Controllers:
    """Return all loaded controllers."""
    return wire.Controllers.model_validate({"controllers": station.controllers()})


def switch_result(result: SwitchResult) -> wire.SwitchResult:
    """Return the result of a switch, and the ignored parts of its request."""
    return wire.SwitchResult(
        ok=result.ok,
        started=list(result.started),
        stopped=list(result.stopped),
        outcome=result.outcome.value,
        failed=dict(result.failed),
        ignored=list(result.plan.ignored),
        order=[info.name for info in result.plan.running],
        chained=list(result.plan.chained),
        jump=dict(result.jump),
        cycle=result.cycle,
        dry_run=result.dry_run,
    )


def gains(found: tunables.Gains, etag: str) -> wire.Gains:
    """Return gains with their units and ranges, and their entity tag."""
    return wire.Gains.model_validate({
        "values": found.values,
        "schema": found.schema,
        "revision": found.revision,
        "etag": etag,
    })


def command_info(found: SetPoint) -> wire.CommandInfo:
    """Return the elements of a controller's set-point, and the last set-point."""
    return wire.CommandInfo.model_validate({
        "elements": found.elements,
        "last": found.values,
    })


def controller_sample(
    sample: ControllerSample,
    names: list[str],
    published: Mapping[str, Mapping[str, object]] | None = None,
) -> wire.ControllerSample:
    """Return a controller's sample of one cycle and its latest messages."""
    messages = {
        topic: {key: _json(value) for key, value in message.items()}
        for topic, message in (published or {}).items()
    }
    return wire.ControllerSample.model_validate({
        **sample._asdict(),
        "name": names,
        "published": messages,
    })


def goal(found: Goal) -> wire.Goal:
    """Return a goal: its progress and feedback, and its result once it has ended."""
    result = found.result
    is_active = found.status is GoalStatus.ACTIVE
    return wire.Goal.model_validate({
        "id": found.identifier,
        "status": found.status,
        "progress": found.progress,
        "cancel_requested": found.cancel_requested,
        "feedback": (_message(found.feedback()) or None) if is_active else None,
        "result": None
        if result is None
        else {
            "code": result.code,
            "message": result.message,
            "details": _message(result.details),
        },
    })


def _message(values: Mapping[str, object]) -> dict[str, JsonValue]:
    return {key: _json(value) for key, value in values.items()}


def _json(value: object) -> JsonValue:
    """Return a value of a controller's message with only the types that JSON has."""
    if isinstance(value, float):
        return None if finite_or_none(value) is None else value
    if isinstance(value, Mapping):
        return {str(key): _json(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_json(each) for each in value]
    return value if isinstance(value, (bool, int)) or value is None else str(value)


def desired_state(state: PosVelAccState, names: list[str]) -> wire.DesiredState:
    """Return the desired state of joints, with their names."""
    return wire.DesiredState(
        name=names,
        position=list(state.position),
        velocity=list(state.velocity),
        acceleration=list(state.acceleration),
    )


def joint_states(snapshot: Snapshot, names: list[str]) -> wire.JointStates:
    """Return the joints of one cycle, with their names."""
    return wire.JointStates(
        stamp=snapshot.stamp,
        name=names,
        position=list(snapshot.position),
        velocity=list(snapshot.velocity),
        effort=list(snapshot.effort),
    )


def hardware(report: HardwareReport) -> wire.Hardware:
    """Return the robot's interfaces, limits, transmissions and clamps."""
    return wire.Hardware.model_validate({
        "interfaces": report.interfaces,
        "limits": [_limits(found) for found in report.limits],
        "transmissions": report.transmissions,
        "clamps": clamps(report.clamps),
        "repairs": report.repairs,
    })


def clamps(reports: Iterable[ClampReport]) -> list[wire.Clamp]:
    """Return the commands that limits have cut off: their number and the last one."""
    return [
        wire.Clamp(
            joint=report.last.joint,
            hardware_interface=report.hardware_interface,
            count=report.count,
            asked=report.last.asked,
            given=report.last.given,
            reason=report.last.reason.value,
        )
        for report in reports
    ]


def _limits(report: JointLimitsReport) -> wire.HardwareLimits:
    return wire.HardwareLimits.model_validate({
        **asdict(report.limits),
        "joint": report.joint,
        "soft_limits": report.soft_limits,
        "sources": report.sources,
    })


def stop_state(station: Station) -> wire.StopState:
    """Return the latched stop and the present epoch."""
    latch = station.loop.stop_latch
    return wire.StopState.model_validate({
        "state": latch.state,
        "reason": latch.reason,
        "epoch": station.epoch,
        "pending": latch.pending,
    })


def status(
    station: Station,
    versions: dict[str, str],
    events: EventLogState,
    operator: str | None = None,
) -> wire.Status:
    """Return the station at a glance, with its arms and versions.

    Args:
        station: The station.
        versions: Versions of the packages.
        events: State of the event log.
        operator: Name of the holder of control.
    """
    found = station.status()
    return wire.Status.model_validate({
        **{field.name: getattr(found, field.name) for field in fields(found)},
        "robots": arms(station),
        "versions": versions,
        "events": events,
        "operator": operator,
        "clamps": clamps(found.clamps),
        "command_violations": {
            "count": found.command_violations,
            "last": found.last_command_violation,
        },
    })


def alarm(found: Alarm) -> wire.Alarm:
    """Return an alarm with its cause."""
    known = asdict(found)
    return wire.Alarm.model_validate({**known, **known.pop("cause")})


def arm_report(found: ArmReport) -> wire.ArmReport:
    """Return an arm at a glance, with the route that carries out its remedy."""
    report = wire.ArmReport.model_validate(found)
    if found.robot_mode is not RobotMode.REFLEX:
        return report
    route = f"POST /robots/{found.arm_id}/error_recovery"
    return report.model_copy(update={"remedy": f"{report.remedy} ({route})"})


def arms(station: Station) -> list[wire.ArmReport]:
    """Return all arms at a glance."""
    return [arm_report(found) for found in Arms(station.robots).reports()]


_ARM_FIELDS = tuple(field.name for field in fields(RobotState))


def franka_state(found: RobotState, nearest: Clearance | None) -> dict[str, object]:
    """Return the fields of `FrankaState`: the state of an arm and its nearest pair."""
    values: dict[str, object] = {name: getattr(found, name) for name in _ARM_FIELDS}
    values["robot_mode"] = found.robot_mode.name.lower()
    for flags in ("current_errors", "last_motion_errors"):
        values[flags] = error_names(getattr(found, flags))
    if nearest is None:
        return {**values, "least_clearance": None, "nearest_pair": []}
    pair = [nearest.link, nearest.object]
    return {**values, "least_clearance": nearest.distance, "nearest_pair": pair}


def gripper(arm_id: str, found: GripperState) -> wire.Gripper:
    """Return the state of a gripper, with the name of its arm."""
    state = {field.name: getattr(found, field.name) for field in fields(found)}
    return wire.Gripper.model_validate({"arm_id": arm_id, **state})
