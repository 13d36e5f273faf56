"""What the bar at the top of the page shows, as plain data."""

from dataclasses import dataclass

from station.ui.station_view import StationView
from station.wire import Status


@dataclass(frozen=True, slots=True)
class BarState:
    """The status strip: is the station there, how does it do, may the robot move.

    Attributes:
        link: `live`, `stale` (data too old to trust) or `lost` (no answer).
        age: How old the newest data is [s]; None before the first.
        robot: `SIMULATION` or `REAL ARM` with its address; empty while unknown.
        mode: What the robot says it does, and its errors if it has some.
        stop_state: `armed`, `stopped` or `released`; empty while unknown.
        stop_reason: Why the stop was engaged last.
        rate_hz: Measured rate of the control loop [Hz].
        lateness_p99: p99 of the lateness of the cycles [s].
        real_time_factor: Station time over wall time, as measured; None while unknown.
        paused: Simulated time stands still.
        epoch: Changes at each stop, reset and recovery.
        message: The last refusal or failure, as the station words it.
        refused: The last refusal alone while it is recent: of Viser's panel or a pull.
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
    """Return what the bar shows of `view`.

    Args:
        view: What is known of the station.
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
    """Return the robot's mode; with what is wrong and what to do when it is halted."""
    wrong = []
    for arm in status.robots:
        if arm.remedy:
            names = ", ".join(dict.fromkeys(error.name for error in arm.errors))
            remedy = arm.remedy.partition(" (")[0]  # here is a button instead
            wrong.append(f"{arm.arm_id}: {names or arm.robot_mode}: {remedy}")
    paused = status.simulation is not None and status.simulation.paused
    mode = f"{status.robot_mode}, paused" if paused else status.robot_mode
    return " · ".join([mode, *wrong])
