"""The plan of a switch: the controllers to start and to stop, or a refusal.

Planning is a pure function of the loaded controllers and the request.
`controller_update.py` carries a plan out.

Source: ros_control@0.20.0 controller_manager/src/controller_manager.cpp,
ControllerManager::switchController; differs: a refusal states its reason.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import NamedTuple

from station.core.control.controller import ControllerState
from station.core.errors import ResourceConflictError, SwitchRefusedError, suggest
from station.core.hardware.robot_hw import ControllerInfo, ResourceConflict
from station.core.ports.command_ticket import CommandTicket


class Strictness(Enum):
    """The treatment of a request that is only possible in part."""

    BEST_EFFORT = 1
    """Do the possible part of the request, leave out the rest."""
    STRICT = 2
    """Do the whole request, or refuse it."""
    AUTO = 3
    """As strict, and also start the following controllers that a start needs, and stop
    the preceding controllers that a stop leaves without their following ones."""
    FORCE_AUTO = 4
    """As auto, and also stop the controllers that hold resources that a start needs."""

    @classmethod
    def from_value(cls, value: int) -> "Strictness":
        """Return the strictness of a number in a ROS message (CM-39).

        2 is strict; 3 and 4 are those of ros2_control; all else is best effort.
        """
        known = {one.value: one for one in cls}
        return known.get(value, cls.BEST_EFFORT)

    @property
    def follows_chains(self) -> bool:
        """True if a request is extended by the controllers that its chains need."""
        return self in {Strictness.AUTO, Strictness.FORCE_AUTO}


SWITCH_BOUND = 5.0
"""Default of the wall time that a switch without a timeout may take [s]."""


class SwitchOutcome(Enum):
    """The outcomes of a switch; see `switch_transaction.py`."""

    COMMITTED = "committed"
    """All that was possible was done; `failed` gives the reasons for the rest."""
    ROLLED_BACK = "rolled_back"
    """The controllers that ran before run again, in the same modes."""
    HALTED = "halted"
    """Controllers of the switch were stopped and their resources rest, because the
    hardware carried out neither the switch nor its reversal."""


@dataclass(frozen=True, slots=True)
class SwitchRequest:
    """The controllers to start and to stop, in one cycle.

    Attributes:
        start: Names to start; started in this order.
        stop: Names to stop; stopped in this order.
        strictness: Treatment of a request that is only possible in part.
        start_asap: Start each controller as soon as the hardware is ready for it,
            instead of all when it is ready for all.
        timeout: How long the hardware may take [s station time], >= 0; 0 for as long
            as it takes, up to `bound`.
        bound: How long a switch without a timeout may take [s wall time], > 0; None for
            no limit, as in ros_control.
        dry_run: Only return the plan.
        zero_period: Update each started controller once with a period of zero, in the
            cycle in which it is started, as after a recovery.
        ticket: Notes the cycle in which the switch begins.
    """

    start: Sequence[str] = ()
    stop: Sequence[str] = ()
    strictness: Strictness = Strictness.STRICT
    start_asap: bool = False
    timeout: float = 0.0
    bound: float | None = SWITCH_BOUND
    dry_run: bool = False
    zero_period: bool = False
    ticket: CommandTicket | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class SwitchPlan:
    """The effect that a switch will have.

    Attributes:
        start_requests: Names to start in the order of the request, where a name may be
            repeated (CM-51).
        stop_requests: Names to stop in the order of the request.
        start: Controllers that are not running and will be, in load order.
        stop: Controllers that are running and will not be, in load order.
        running: Controllers that run after the switch, in the order of their updates.
        ignored: Why parts of the request were left out; best effort only.
        chained: Names of controllers that are in chained mode after the switch.
    """

    start_requests: tuple[str, ...]
    stop_requests: tuple[str, ...]
    start: tuple[ControllerInfo, ...]
    stop: tuple[ControllerInfo, ...]
    running: tuple[ControllerInfo, ...]
    ignored: tuple[str, ...]
    chained: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class SwitchResult:
    """The effect of a switch, or with `dry_run` the effect that it would have.

    Attributes:
        ok: Whether the controllers and the hardware are as the plan says.
        started: Names that were started and run, in load order.
        stopped: Names that were stopped and do not run, in load order.
        outcome: How the switch ended.
        failed: By name, why a controller is not as requested, or why one that ran
            before does not run again.
        jump: By resource, the distance of its first command from the last one, in the
            unit of the command.
        cycle: Cycle in which it was finished; 0 for a dry run.
        plan: The plan.
        dry_run: Whether nothing was done.
    """

    ok: bool
    started: tuple[str, ...]
    stopped: tuple[str, ...]
    cycle: int
    plan: SwitchPlan
    outcome: SwitchOutcome = SwitchOutcome.COMMITTED
    failed: dict[str, str] = field(default_factory=dict)
    jump: dict[str, float] = field(default_factory=dict)
    dry_run: bool = False


class Candidate(NamedTuple):
    """A loaded controller as the planner sees it."""

    info: ControllerInfo
    state: ControllerState
    is_unreleased: bool = False
    """Whether the robot has not confirmed that the controller has stopped."""
    following: tuple[str, ...] = ()
    """Names of the controllers whose references this controller commands."""
    read: tuple[str, ...] = ()
    """Names of the controllers whose states this controller reads."""

    @property
    def needed(self) -> tuple[str, ...]:
        """Names of the controllers without which this controller does not run."""
        return (*self.following, *self.read)


class _Draft:
    """A plan in the making."""

    def __init__(self, *, strict: bool) -> None:
        self.strict = strict
        self.start: list[ControllerInfo] = []
        self.stop: list[ControllerInfo] = []
        self.running: list[ControllerInfo] = []
        self.ignored: list[str] = []

    def object_to(
        self, name: str, problem: str, remedy: str, add: Sequence[str] = ()
    ) -> None:
        """Refuse if strict; otherwise note that this part is left out.

        Args:
            name: The controller.
            problem: The impossible part of the request.
            remedy: Advice for the caller.
            add: Names that would make it possible if they were added.

        Raises:
            SwitchRefusedError: The plan is strict.
        """
        message = f"Controller '{name}' {problem}."
        if self.strict:
            details: dict[str, object] = {"controller": name}
            if add:
                details["add"] = list(add)
            raise SwitchRefusedError(message, remedy=remedy, details=details)
        self.ignored.append(message)


def plan_switch(loaded: Sequence[Candidate], request: SwitchRequest) -> SwitchPlan:
    """Return the plan of `request` for the loaded controllers.

    Args:
        loaded: All loaded controllers, in load order.
        request: Request of the caller.

    Raises:
        SwitchRefusedError: The request is strict and a part of it is impossible
            (CM-40 … CM-43, CM-50); or a running controller is to be both stopped
            and started (CM-49).
    """
    draft = _Draft(strict=request.strictness is not Strictness.BEST_EFFORT)
    names = [candidate.info.name for candidate in loaded]
    stop = _known(draft, request.stop, names, "stop")
    start = _known(draft, request.start, names, "start")
    if request.strictness.follows_chains:
        _add_to_chains(loaded, start, stop)
    _check_chains(draft, loaded, start, stop)
    for one in loaded:
        _plan_controller(draft, one, one.info.name in start, one.info.name in stop)
    running = {info.name for info in draft.running}
    commanded = {n for one in loaded if one.info.name in running for n in one.following}
    return SwitchPlan(
        tuple(start),
        tuple(stop),
        tuple(draft.start),
        tuple(draft.stop),
        tuple(draft.running),
        tuple(draft.ignored),
        tuple(info.name for info in draft.running if info.name in commanded),
    )


def _runs_after(one: Candidate, start: Sequence[str], stop: Sequence[str]) -> bool:
    name = one.info.name
    runs = one.state is ControllerState.RUNNING and name not in stop
    return runs or name in start


def _add_to_chains(
    loaded: Sequence[Candidate], start: list[str], stop: list[str]
) -> None:
    """Add controllers that are needed to `start`, and those that need to `stop`.

    A controller that the request names in both lists stays in both.
    """
    # Each pass follows every chain by one controller at least.
    for one in [*loaded] * len(loaded):
        name = one.info.name
        if name in start:
            start += [
                each.info.name
                for each in loaded
                if each.info.name in one.needed
                and not _runs_after(each, start, stop)
                and each.info.name not in stop
            ]
    for one in [*reversed(loaded)] * len(loaded):
        name = one.info.name
        needs_stopped = not set(one.needed).isdisjoint(stop)
        runs = one.state is ControllerState.RUNNING and name not in stop
        if needs_stopped and runs and name not in start:
            stop.append(name)


def _check_chains(
    draft: _Draft, loaded: Sequence[Candidate], start: list[str], stop: list[str]
) -> None:
    """Leave out controllers that would run without those that they need.

    Raises:
        SwitchRefusedError: There is such a controller, and the plan is strict.
    """
    by_name = {one.info.name: one for one in loaded}
    # From the hardware upwards: leaving one out may leave out those above it.
    for one in [*reversed(loaded)] * len(loaded):
        name = one.info.name
        missing = [
            each for each in one.needed if not _runs_after(by_name[each], start, stop)
        ]
        if not missing or not _runs_after(one, start, stop):
            continue
        if name in start:
            add = _followers(by_name, one, start, stop)
            does = "it commands"
            if not set(missing) & set(one.following):
                does = "it reads states of"
            draft.object_to(
                name,
                f"cannot start: {does} {_quoted(missing)}, which would not run",
                f"Add {_quoted(add)} to 'start'.",
                add=add,
            )
            start[:] = [each for each in start if each != name]
    for one in loaded:
        name = one.info.name
        runs = one.state is ControllerState.RUNNING and name not in stop
        missing = [each for each in one.needed if each in stop]
        if not runs or not missing:
            continue
        add = _preceding(loaded, missing, stop)
        is_commanded = missing[0] in one.following
        used = "it is commanded" if is_commanded else "its states are read"
        draft.object_to(
            missing[0],
            f"cannot stop: {used} by {_quoted([name])}, which runs",
            f"Add {_quoted(add)} to 'stop'.",
            add=add,
        )
        _keep_running(by_name, one, stop)


def _followers(
    by_name: dict[str, Candidate],
    one: Candidate,
    start: Sequence[str],
    stop: Sequence[str],
) -> list[str]:
    """Return the controllers that `one` needs down its chain and that would not run."""
    found: dict[str, None] = {}
    for name in one.needed:
        each = by_name[name]
        if not _runs_after(each, start, stop):
            found[name] = None
        found.update(dict.fromkeys(_followers(by_name, each, start, stop)))
    return list(found)


def _preceding(
    loaded: Sequence[Candidate], names: Sequence[str], stop: Sequence[str]
) -> list[str]:
    """Return the running controllers above some names, preceding ones first."""
    above = set(names)
    found: list[str] = []
    for one in [*reversed(loaded)] * len(loaded):
        name = one.info.name
        if name not in above and not above.isdisjoint(one.needed):
            above.add(name)
            if one.state is ControllerState.RUNNING and name not in stop:
                found.insert(0, name)
    return found


def _keep_running(
    by_name: dict[str, Candidate], one: Candidate, stop: list[str]
) -> None:
    """Take all controllers down the chain of `one` out of `stop`."""
    for name in one.needed:
        stop[:] = [each for each in stop if each != name]
        _keep_running(by_name, by_name[name], stop)


def _quoted(names: Iterable[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)


def _known(
    draft: _Draft, wanted: Iterable[str], names: list[str], verb: str
) -> list[str]:
    known: list[str] = []
    what_to_do = "Load it first." if verb == "start" else f"Leave it out of '{verb}'."
    for name in wanted:
        if name in names:
            known.append(name)
            continue
        draft.object_to(
            name,
            f"cannot {verb}: it is not loaded",
            f"{suggest(name, names)} {what_to_do}",
        )
    return known


def _plan_controller(
    draft: _Draft,
    one: Candidate,
    start: bool,  # noqa: FBT001 - private, named at its only call
    stop: bool,  # noqa: FBT001
) -> None:
    info, state = one.info, one.state
    name = info.name
    running = state is ControllerState.RUNNING
    if stop and not running and not one.is_unreleased:
        draft.object_to(
            name,
            f"cannot stop: it is {state.value}, not running",
            "Leave it out of 'stop'.",
        )
        stop = False
    if start and running and not stop:
        draft.object_to(
            name, "cannot start: it is running already", "Leave it out of 'start'."
        )
        start = False
    if start and stop:
        raise SwitchRefusedError(
            f"Controller '{name}' is to be stopped and started in one switch.",
            remedy="Stop it in one switch and start it in the next.",
            details={"controller": name},
        )
    if stop:
        draft.stop.append(info)
    if start:
        draft.start.append(info)
    if start or (running and not stop):
        draft.running.append(info)


def conflict_error(
    conflicts: Sequence[ResourceConflict], running: Iterable[str]
) -> ResourceConflictError:
    """Return the error that names the controllers and the disputed resources.

    `details["conflicts"]` has one entry per resource: `resource`; `reason`;
    `claimed_by`, the controllers and their hardware interfaces; `held_by`, the running
    controller among them or None; and that controller's `hardware_interface`.
    `details["held_by"]` lists all running controllers that are in the way.

    Args:
        conflicts: Objections of the hardware, at least one.
        running: Names of the controllers that run now.
    """
    now = set(running)
    entries = [_describe_conflict(conflict, now) for conflict in conflicts]
    holders = sorted({str(e["held_by"]) for e in entries if e["held_by"]})
    remedy = "Start only one of them."
    if holders:
        remedy = f"Stop {', '.join(repr(name) for name in holders)} in the same switch."
    return ResourceConflictError(
        _summary(conflicts),
        remedy=remedy,
        details={"conflicts": entries, "held_by": holders},
    )


def _summary(conflicts: Sequence[ResourceConflict]) -> str:
    """Return a reason for each group of holders, and all resources it applies to."""
    groups: dict[tuple[tuple[str, str], ...], list[ResourceConflict]] = {}
    for conflict in conflicts:
        groups.setdefault(conflict.holders, []).append(conflict)
    sentences = []
    for first, *others in groups.values():
        more = sorted({one.resource for one in others} - {first.resource})
        also = f" The same goes for {', '.join(more)}." if more else ""
        sentences.append(first.reason + also)
    return " ".join(sentences)


def _describe_conflict(
    conflict: ResourceConflict, running: set[str]
) -> dict[str, object]:
    held = [holder for holder in conflict.holders if holder[0] in running]
    owner = (held or list(conflict.holders) or [("", "")])[0]
    return {
        "resource": conflict.resource,
        "hardware_interface": owner[1],
        "held_by": held[0][0] if held else None,
        "claimed_by": [
            {"controller": name, "hardware_interface": interface}
            for name, interface in conflict.holders
        ],
        "reason": conflict.reason,
    }
