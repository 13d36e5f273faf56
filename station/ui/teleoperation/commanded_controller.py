"""Choose the running controller that takes a person's set-points."""

from dataclasses import dataclass

from station.ui.link.station_view import (
    StationView,
    choose_recovery,
    moves_hand,
    moves_joints,
)
from station.wire import CommandElement


@dataclass(frozen=True, slots=True)
class CommandedController:
    """The controller that takes set-points, or the reason why there is none.

    Attributes:
        name: Its name; empty when there is none.
        elements: The numbers of its set-point, in order.
        reason: Why it takes no set-points now; empty when it does.
    """

    name: str = ""
    elements: tuple[CommandElement, ...] = ()
    reason: str = ""


def choose_for_joints(view: StationView) -> tuple[CommandedController, ...]:
    """Return all running controllers that take set-points of joints.

    Two arms may have a controller each. No two of them command the same joint.

    Returns:
        The controllers; if there are none, one entry without a name has the reason.
    """
    found = tuple(
        CommandedController(controller.name, tuple(elements), view.blocked())
        for controller in view.controllers
        if controller.state == "running"
        and moves_joints(elements := view.elements.get(controller.name, ()))
    )
    return found or (CommandedController(reason=_why_none(view)),)


def _why_none(view: StationView) -> str:
    """Return the reason why no controller takes set-points of joints."""
    if view.blocked():
        return view.blocked()
    if choose_recovery(view).trouble:
        return "An arm has stopped by itself. The line at the top says what to do."
    running = [c.name for c in view.controllers if c.state == "running"]
    hands = [name for name in running if moves_hand(view.elements.get(name, ()))]
    if hands:
        return (
            f"{hands[0]} moves the end effector. To move single joints, start a group "
            "controller in its place in the dock Controllers."
        )
    what = f"Only {', '.join(running)} runs" if running else "No controller runs"
    return (
        f"{what}, and nothing that runs takes set-points. Start a group controller in "
        "the dock Controllers."
    )


def choose_for_hand(
    view: StationView, names: tuple[str, ...], kind: str, arm: str = ""
) -> CommandedController:
    """Return the running controller of these elements, or the reason for none.

    Args:
        view: The dashboard's knowledge of the station.
        names: The elements, `TWIST` or `POSE`.
        kind: End of the type of such controllers, e.g. `CartesianJogController`.
        arm: The arm whose end effector is moved; empty unless there are several.
    """
    controllers = [c for c in view.controllers if not arm or arm in view.arms_of(c)]
    for controller in controllers:
        elements = view.elements.get(controller.name, ())
        if controller.state == "running" and (
            tuple(element.name for element in elements) == names
        ):
            return CommandedController(controller.name, tuple(elements), view.blocked())
    if view.blocked():
        return CommandedController(reason=view.blocked())
    loaded = [c.name for c in controllers if c.type.endswith(kind)]
    if loaded:
        reason = f"Start {loaded[0]} in the dock Controllers."
    elif any(kind in known.type for known in view.types):
        what = f"{kind} of {arm}" if arm else kind
        reason = f"Load a {what} in the dock Controllers, and start it."
    else:
        reason = f"This station has no {kind}."
    return CommandedController(reason=reason)


def arms_to_move(view: StationView) -> list[str]:
    """Return the arms between which a person chooses.

    Returns:
        Their names; one empty name if there are fewer than two, because every
        controller then belongs to the same arm.
    """
    arms = [] if view.status is None else [arm.arm_id for arm in view.status.robots]
    return arms if len(arms) > 1 else [""]
