"""The settings that the station hands to its watchdog at the start."""

from typing import NamedTuple

NOTICE_AFTER = 0.08
"""A wake-up of the loop older than this is a stall [s]; seen every `LOOK_PERIOD`, it is
told within 0.1 s."""
LOOK_PERIOD = 0.01
"""How often the watchdog looks [s]."""


class WatchdogSettings(NamedTuple):
    """The watched process, and the reaction to a loop that stands still.

    Attributes:
        pid: The station's process.
        operator_token: Token that may do everything here.
        viewer_token: Token that may read and stop.
        incident_directory: Where incident files are written; made when needed.
        hold_commands: Command lines that make the drivers of real arms hold; each is
            started without a shell when the loop stalls, and must end within 1 s.
        stack_signal: Signal upon which the station writes the stacks of its threads to
            `stacks`, interpreter or not; 0: none.
        notice_after: Age of the last wake-up that counts as a stall [s], > 0.
        end_after: Duration of a stall after which the station is ended [s]; None: the
            watchdog never ends it.
    """

    pid: int
    operator_token: str
    viewer_token: str
    incident_directory: str
    hold_commands: tuple[tuple[str, ...], ...] = ()
    stack_signal: int = 0
    notice_after: float = NOTICE_AFTER
    end_after: float | None = 10.0
