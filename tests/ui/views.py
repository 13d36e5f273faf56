"""Station views to try the models with."""

from station.ui.link.station_view import StationView
from station.wire import (
    ArmReport,
    ClaimedResources,
    CommandElement,
    ControllerSample,
    ControllerState,
    LoopReport,
    Percentiles,
    Status,
)

TIMES = Percentiles(p50=0.0, p99=1.5e-4, p999=2e-4, max=1e-3, count=10)
LOOP = LoopReport(
    state="running",
    failure="",
    rate=1000.0,
    achieved_rate=999.5,
    period=1e-3,
    cycles=10,
    skipped=0,
    real_time_factor=1.0,
    achieved_real_time_factor=1.0,
    lateness=TIMES,
    read=TIMES,
    update=TIMES,
    write=TIMES,
    total=TIMES,
    scheduler="",
)


def arm(arm_id, mode, remedy="", errors=()):
    """Return an arm."""
    return ArmReport(
        arm_id=arm_id,
        robot_mode=mode,
        connected=True,
        errors=list(errors),
        remedy=remedy,
    )


def status(stop_state="armed", epoch=1, robots=()):
    """Return a status."""
    return Status(
        boot_id="boot",
        epoch=epoch,
        time=1.0,
        cycle=10,
        robot_type="franka_hw/FrankaHW",
        robot_label="SIMULATION",
        robot_mode="idle",
        stop_state=stop_state,
        stop_reason="",
        loop=LOOP,
        versions={},
        robots=list(robots),
    )


def controller(name, state="initialized", joints=("joint1", "joint2", "joint3")):
    """Return a controller that claims `joints`."""
    claims = ClaimedResources(
        hardware_interface="hardware_interface::EffortJointInterface",
        resources=list(joints),
    )
    return ControllerState(
        name=name,
        type="family/Kind",
        state=state,
        claimed_resources=[claims],
        fault=None,
        traceback=None,
        fallback=[],
        time=TIMES,
    )


def element(name="joint1", unit="rad", minimum=-1.0, maximum=1.0):
    """Return an element of a set-point."""
    return CommandElement(name=name, unit=unit, minimum=minimum, maximum=maximum)


def sample(stamp, desired=0.0, actual=0.0, error=0.0, names=("joint1",)):
    """Return a controller's sample; every element has the same numbers."""
    n = len(names)
    return ControllerSample(
        stamp=stamp,
        name=list(names),
        desired=[desired] * n,
        actual=[actual] * n,
        error=[error] * n,
        output=[0.0] * n,
    )


def view(*controllers, age=0.1, stop_state="armed", **rest):
    """Return what is known of a station, `age` seconds old."""
    return StationView(
        now=10.0,
        heard_at=10.0 - age,
        status=status(stop_state),
        controllers=controllers,
        **rest,
    )
