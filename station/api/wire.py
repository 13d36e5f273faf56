"""From the core's values to the wire models."""

from collections.abc import Mapping, Sequence
from typing import cast

from pydantic import JsonValue

from station import wire as schemas
from station.api import robot_wire, wire_hardware
from station.api.wire_numbers import measured, measured_list
from station.core.control import tunables
from station.core.control.controller import ControllerSample
from station.core.control.controller_manager import ControllerStatus
from station.core.control.switching import SwitchResult
from station.core.facade.simulation_control import SimulationReport
from station.core.facade.station import Station
from station.core.hardware.robot_report import SceneObjectReport
from station.core.loop import loop_report
from station.core.loop.snapshot import Snapshot
from station.core.numerics import statistics
from station.core.ports.goal import Goal, GoalStatus
from station.core.ports.set_point import SetPoint, SetPointElement
from station.core.trajectory import PosVelAccState


def percentiles(found: statistics.Percentiles) -> schemas.Percentiles:
    """Return a distribution of durations."""
    return schemas.Percentiles(
        p50=found.p50,
        p99=found.p99,
        p999=found.p999,
        max=found.max,
        count=found.count,
    )


def controller_state(status: ControllerStatus) -> schemas.ControllerState:
    """Return a controller as the listing shows it."""
    return schemas.ControllerState(
        name=status.name,
        type=status.type,
        state=status.state.value,
        claimed_resources=[
            schemas.ClaimedResources(
                hardware_interface=claim.hardware_interface,
                resources=list(claim.resources),
            )
            for claim in status.claimed_resources
        ],
        fault=status.fault,
        traceback=status.traceback,
        fallback=list(status.fallback),
        time=percentiles(status.time),
    )


def controllers(station: Station) -> schemas.Controllers:
    """Return all loaded controllers."""
    return schemas.Controllers(
        controllers=[controller_state(status) for status in station.controllers()]
    )


def switch_result(result: SwitchResult) -> schemas.SwitchResult:
    """Return what a switch did."""
    return schemas.SwitchResult(
        ok=result.ok,
        started=list(result.started),
        stopped=list(result.stopped),
        failed=dict(result.failed),
        ignored=list(result.plan.ignored),
        jump={name: measured(jump) for name, jump in result.jump.items()},
        cycle=result.cycle,
        dry_run=result.dry_run,
    )


def gains(found: tunables.Gains, etag: str) -> schemas.Gains:
    """Return gains with what they may be."""
    return schemas.Gains(
        values=found.values,
        schema={
            name: schemas.Tunable(
                unit=tunable.unit,
                minimum=measured(tunable.minimum),
                maximum=measured(tunable.maximum),
                description=tunable.description,
            )
            for name, tunable in found.schema.items()
        },
        revision=found.revision,
        etag=etag,
    )


def command_info(found: SetPoint) -> schemas.CommandInfo:
    """Return what a controller takes as set-point."""
    last = found.values
    return schemas.CommandInfo(
        elements=[_command_element(element) for element in found.elements],
        last=None if last is None else measured_list(last),
    )


def _command_element(element: SetPointElement) -> schemas.CommandElement:
    return schemas.CommandElement(
        name=element.name,
        unit=element.unit,
        minimum=measured(element.minimum),
        maximum=measured(element.maximum),
    )


def controller_sample(
    sample: ControllerSample,
    names: list[str],
    published: Mapping[str, Mapping[str, object]] | None = None,
) -> schemas.ControllerSample:
    """Return what a controller did in one cycle, and what it published."""
    return schemas.ControllerSample(
        published={
            topic: {key: _value(value) for key, value in message.items()}
            for topic, message in (published or {}).items()
        },
        stamp=sample.stamp,
        name=names,
        desired=measured_list(sample.desired),
        actual=measured_list(sample.actual),
        error=measured_list(sample.error),
        output=measured_list(sample.output),
    )


def goal(found: Goal) -> schemas.Goal:
    """Return a goal and how far it is."""
    result = found.result
    is_active = found.status is GoalStatus.ACTIVE
    feedback = found.feedback() if is_active else {}
    return schemas.Goal(
        id=found.identifier,
        status=found.status.value,
        progress=found.progress,
        cancel_requested=found.cancel_requested,
        feedback={key: _value(value) for key, value in feedback.items()} or None,
        result=None
        if result is None
        else schemas.GoalResult(
            code=result.code,
            message=result.message,
            details={key: _value(value) for key, value in result.details.items()},
        ),
    )


def _value(value: object) -> JsonValue:
    """Return a value of a message as JSON has it."""
    if isinstance(value, float):
        return measured(value)
    if isinstance(value, Mapping):
        return {str(key): _value(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_value(each) for each in value]
    return value if isinstance(value, (bool, int)) or value is None else str(value)


def desired_state(state: PosVelAccState, names: list[str]) -> schemas.DesiredState:
    """Return where joints shall be."""
    return schemas.DesiredState(
        name=list(names),
        position=measured_list(state.position),
        velocity=measured_list(state.velocity),
        acceleration=measured_list(state.acceleration),
    )


def joint_states(snapshot: Snapshot, names: list[str]) -> schemas.JointStates:
    """Return the joints of one cycle."""
    return schemas.JointStates(
        stamp=snapshot.stamp,
        name=names,
        position=measured_list(snapshot.position),
        velocity=measured_list(snapshot.velocity),
        effort=measured_list(snapshot.effort),
    )


def loop(found: loop_report.LoopReport) -> schemas.LoopReport:
    """Return how the loop does."""
    return schemas.LoopReport(
        state=found.state.value,
        failure=found.failure,
        rate=found.rate,
        achieved_rate=found.achieved_rate,
        period=found.period,
        cycles=found.cycles,
        skipped=found.skipped,
        real_time_factor=found.real_time_factor,
        achieved_real_time_factor=found.achieved_real_time_factor,
        lateness=percentiles(found.lateness),
        read=percentiles(found.read),
        update=percentiles(found.update),
        write=percentiles(found.write),
        total=percentiles(found.total),
        scheduler=found.scheduler,
    )


def scene(found: Sequence[SceneObjectReport]) -> schemas.Scene:
    """Return the things around a robot."""
    return schemas.Scene(
        objects=[
            schemas.SceneObject(
                name=thing.name,
                type=cast("schemas.ObjectKind", thing.kind),
                size=list(thing.size),
                position=measured_list(thing.position),
                orientation=measured_list(thing.orientation),
                mass=thing.mass,
                file=thing.file,
            )
            for thing in found
        ]
    )


def simulation(found: SimulationReport) -> schemas.Simulation:
    """Return the pace of a simulation."""
    return schemas.Simulation(
        paused=found.paused,
        real_time_factor=found.real_time_factor,
        time=found.time,
        steps_due=found.steps_due,
    )


def stop_state(station: Station) -> schemas.StopState:
    """Return the latched stop."""
    latch = station.loop.stop_latch
    return schemas.StopState(
        state=latch.state.value,
        reason=latch.reason,
        epoch=station.epoch,
        pending=latch.pending,
    )


def status(station: Station, versions: dict[str, str]) -> schemas.Status:
    """Return the station at a glance."""
    found = station.status()
    return schemas.Status(
        boot_id=found.boot_id,
        epoch=found.epoch,
        time=found.time,
        cycle=found.cycle,
        robot_type=found.robot_type,
        robot_mode=found.robot_mode,
        stop_state=found.stop_state.value,
        stop_reason=found.stop_reason,
        loop=loop(found.loop),
        simulation=None if found.simulation is None else simulation(found.simulation),
        robots=[robot_wire.arm_report(r) for r in station.robots.reports()],
        versions=versions,
        clamps=wire_hardware.clamps(found.clamps),
    )
