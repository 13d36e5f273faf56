"""What the bar at the top of the page shows, as plain data."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class BarState:
    """The status strip: is the station there, how does it do, may the robot move.

    Attributes:
        link: `live`, `stale` (data too old to trust) or `lost` (no answer).
        age: How old the newest data is [s]; None before the first.
        mode: What the robot says it does.
        stop_state: `armed`, `stopped` or `released`; empty while unknown.
        stop_reason: Why the stop was engaged last.
        rate_hz: Measured rate of the control loop [Hz].
        lateness_p99: p99 of the lateness of the cycles [s].
        epoch: Changes at each stop, reset and recovery.
        message: The last refusal or failure, as the station words it.
    """

    link: str
    age: float | None = None
    mode: str = ""
    stop_state: str = ""
    stop_reason: str = ""
    rate_hz: float | None = None
    lateness_p99: float | None = None
    epoch: int | None = None
    message: str = ""
