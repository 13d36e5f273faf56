"""Choose the recovery of arms after an error or a user stop."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from station.ui.link.station_view import StationView
from station.wire import ArmReport

_NOTHING_MOVES = "Nothing moves by itself; controllers stay stopped."
_MOST_ERRORS = 3


@dataclass(frozen=True, slots=True)
class Recovery:
    """The present action of the recovery button.

    Attributes:
        action: `recover` all arms, `release` the user stops of `arms`, or an empty text
            when there is nothing to do.
        label: Text of the button.
        arms: The arms with an error or a pressed user stop.
        trouble: The errors, for people; empty without an error.
        reason: The effect of the button, or the reason why it is disabled.
    """

    action: Literal["recover", "release", ""] = ""
    label: str = "Recover"
    arms: tuple[str, ...] = ()
    trouble: str = ""
    reason: str = "Nothing to recover: no arm has an error."


def choose_recovery(view: StationView) -> Recovery:
    """Return the recovery that the arms of a station need, if any."""
    if view.link != "live" or view.status is None:
        return Recovery(reason=view.blocked())
    arms = view.status.robots
    stopped = _in_mode(arms, "user_stopped")
    if stopped:
        names = _names(stopped)
        return Recovery(
            "release",
            f"Release the user stop of {names}",
            tuple(arm.arm_id for arm in stopped),
            f"The user stop of {names} is pressed.",
            f"Releases it and clears the errors. {_NOTHING_MOVES}",
        )
    erroneous = _in_mode(arms, "reflex")
    if erroneous:
        names = _names(erroneous)
        return Recovery(
            "recover",
            f"Recover {names}",
            tuple(arm.arm_id for arm in erroneous),
            "; ".join(_trouble(arm) for arm in erroneous),
            f"Remove the cause first. Clears the errors; {names} goes to idle and "
            f"holds its pose. {_NOTHING_MOVES}",
        )
    helpless = [arm for arm in arms if arm.remedy]
    if helpless:
        reason = "; ".join(f"{arm.arm_id}: {arm.remedy}" for arm in helpless)
        modes = [f"{arm.arm_id} is in mode {arm.robot_mode}." for arm in helpless]
        reason = f"No recovery from here: {reason}."
        return Recovery(trouble=" ".join(modes), reason=reason)
    return Recovery()


def _in_mode(arms: Sequence[ArmReport], mode: str) -> list[ArmReport]:
    return [arm for arm in arms if arm.robot_mode == mode]


def _names(arms: Sequence[ArmReport]) -> str:
    return " and ".join(arm.arm_id for arm in arms)


def _trouble(arm: ArmReport) -> str:
    errors = [error.description for error in arm.errors[:_MOST_ERRORS]]
    more = len(arm.errors) - len(errors)
    if more > 0:
        errors.append(f"{more} more")
    return f"{arm.arm_id} stopped itself: {', '.join(errors) or 'an error'}"
