"""One thread of a storm, and the controllers that it works with.

Its operations are random, on its own controllers and on those of all threads.

Only this thread loads, starts and unloads its own controllers, but every thread may
stop them. So the thread knows their true state after each answer, unless another thread
has changed it.
"""

import random
import threading
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from decimal import Decimal
from functools import partial
from math import inf, nan
from typing import NamedTuple, cast

from typing_extensions import override

from station.core.control.chainable_controller import (
    ChainableController,
    Reference,
    ReferenceInterface,
)
from station.core.control.controller import ControllerState
from station.core.control.hardware_components import ComponentState
from station.core.control.switching import Strictness, SwitchRequest
from station.core.errors import ControllerLoadError, ControllerStateError, StationError
from station.core.facade.station import Station
from station.core.hardware.interfaces import (
    EffortJointInterface,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.robot_hw import ControllerInfo, InterfaceResources, RobotHW
from station.core.parameters import Parameters
from station.memory.doubles import zeros
from station.testing.scripted import HookScript
from station.testing.switch_observer import CommandPlace, SwitchObserver, command_places


class Claim(NamedTuple):
    """The claim of a controller of the storm.

    Attributes:
        interface: Wire name of the hardware interface.
        resources: Names of the resources.
    """

    interface: str
    resources: tuple[str, ...]


def find_claims(robot: RobotHW) -> list[Claim]:
    """Return the claims that the robot accepts: of one, several or all resources.

    Args:
        robot: The robot, initialised. It is only asked; no controller is switched.
    """
    by_interface: dict[str, list[str]] = {}
    for place in command_places(robot):
        interface, resource = place.claim
        names = by_interface.setdefault(interface, [])
        if resource not in names:
            names.append(resource)
    return [
        claim
        for interface, names in by_interface.items()
        for claim in dict.fromkeys((
            *(Claim(interface, (name,)) for name in names),
            *_prefixed(interface, names),
            Claim(interface, tuple(names)),
        ))
        if _accepts(robot, claim)
    ]


def _prefixed(interface: str, names: list[str]) -> list[Claim]:
    """Return one claim per arm: the names of its joints agree before `_joint`."""
    prefixes = dict.fromkeys(name.partition("_joint")[0] for name in names)
    return [
        Claim(interface, tuple(n for n in names if n.startswith(f"{prefix}_joint")))
        for prefix in prefixes
        if any(name.startswith(f"{prefix}_joint") for name in names)
    ]


def _accepts(robot: RobotHW, claim: Claim) -> bool:
    info = ControllerInfo("storm", "storm/Controller", (InterfaceResources(*claim),))
    try:
        if robot.check_for_conflict([info]):
            return False
        robot.prepare_switch([info], [])
    except StationError:
        return False
    return True


STORM_TYPE = "storm/Controller"
"""The type under which the storm loads its controllers."""
CALLBACKS = ("starting", "update", "stopping", "waiting", "aborting")
"""The callbacks in which a controller can misbehave."""
BAD_COMMANDS: Sequence[object] = (
    nan,
    inf,
    -inf,
    0j,
    complex(0.5, 0.0),
    10**400,
    Decimal("0.5"),
    Decimal("NaN"),
    "0.5",
    None,
    [0.0],
)
"""Commands that must never reach a robot."""
ODD_COMMANDS: Sequence[object] = (0, 1, True, 1e4, -1e4)
"""Commands that are real numbers, but of another type than float, or large."""
_SPEED: Mapping[str, float] = {
    EffortJointInterface.type_name: 0.1,
    PositionJointInterface.type_name: 2e-6,
    VelocityJointInterface.type_name: 1e-4,
}
"""Change of a command per cycle, by interface."""
_TURN = 100
"""Number of cycles after which the command changes direction."""


@dataclass(frozen=True, slots=True)
class Mischief:
    """A fault that a controller commits once.

    Attributes:
        callback: Callback that commits the fault, one of `CALLBACKS`.
        command: Number to command; None raises an error instead.
        intrudes: Whether the command goes to a resource of another controller.
        place: Index among the controller's commands, or among all commands if it
            intrudes, modulo their number.
    """

    callback: str
    command: tuple[object] | None = None
    intrudes: bool = False
    place: int = 0


class StormController(ChainableController):
    """Claims the resources in its parameters, and moves them a little back and forth.

    Parameters: `interface`, the wire name of a hardware interface; `resources`, names;
    `reference`, the full name of a reference of another controller, or "". It exports
    the reference `value`.

    Attributes:
        mischief: Fault to commit next; None for none. Any thread may set it.
        mischiefs: Number of faults that it has committed.
    """

    def __init__(self) -> None:
        super().__init__()
        self.mischief: Mischief | None = None
        self.mischiefs = 0
        self._places: list[CommandPlace] = []
        self._own: list[CommandPlace] = []
        self._written: list[object] = []
        self._speed = 0.0
        self._cycles = 0
        self._references = zeros(1)

    @override
    def on_export_reference_interfaces(self) -> Sequence[Reference]:
        return (Reference("value", self._references),)

    @override
    def init_request(
        self, hw: RobotHW, params: Parameters
    ) -> tuple[InterfaceResources, ...]:
        """Claim the resources.

        Args:
            hw: The robot.
            params: The parameters of the class.

        Raises:
            ControllerLoadError: The robot has none of these resources; or the parameter
                `mischief` is set.
        """
        interface = params.get_str("interface")
        resources = params.get_str_list("resources")
        if params.get_bool("mischief", default=False):
            raise ControllerLoadError("The storm lets this controller fail in init.")
        # Only commands of the robot: a reference of a controller has a slash in its
        # name.
        self._places = [one for one in command_places(hw) if "/" not in one.claim[1]]
        wanted = {(interface, resource) for resource in resources}
        self._own = [place for place in self._places if place.claim in wanted]
        if {place.claim for place in self._own} != wanted:
            raise ControllerLoadError(
                f"The robot has no commands {resources} in '{interface}'.",
                remedy="Claim what it has.",
            )
        reference, references = params.get_str("reference", ""), None
        if reference:
            references = hw.get(ReferenceInterface)
        if references is not None:
            handle = references.get_handle(reference)
            claim = (ReferenceInterface.type_name, reference)
            storage = cast("list[float]", handle.storage)
            self._own.append(CommandPlace(claim, storage, handle.index, handle.rest))
        self._speed = _SPEED.get(interface, 0.0)
        self.state = ControllerState.INITIALIZED
        return (InterfaceResources(interface, tuple(sorted(resources))),)

    def find_overwritten(self) -> str | None:
        """Return a command that another controller has overwritten, or None.

        The control thread calls it while the controller runs.
        """
        for place, value in zip(self._own, self._written, strict=False):
            now = place.storage[place.index]
            if now != value:
                return f"{place.claim} is commanded {now!r}; its owner wrote {value!r}"
        return None

    @override
    def starting(self, time: float) -> None:
        self._cycles = 0
        self._note_written()
        self._misbehave("starting")

    @override
    def update(self, time: float, period: float) -> None:
        self._cycles += 1
        step = self._speed if self._cycles // _TURN % 2 == 0 else -self._speed
        for place in self._own:
            place.storage[place.index] += step
        self._note_written()
        self._misbehave("update")

    @override
    def stopping(self, time: float) -> None:
        self._misbehave("stopping")

    @override
    def waiting(self, time: float) -> None:
        self._misbehave("waiting")

    @override
    def aborting(self, time: float) -> None:
        self._misbehave("aborting")

    def _note_written(self) -> None:
        self._written = [place.storage[place.index] for place in self._own]

    def _misbehave(self, callback: str) -> None:
        mischief = self.mischief
        if mischief is None or mischief.callback != callback:
            return
        self.mischief = None
        self.mischiefs += 1
        if mischief.command is None:
            raise RuntimeError("the storm lets this callback fail")
        places = self._places if mischief.intrudes else self._own
        place = places[mischief.place % len(places)]
        place.storage[place.index] = cast("float", mischief.command[0])
        # Several interfaces may share a command, so an intruder may own it itself.
        is_own = place.slot in {own.slot for own in self._own}
        if is_own and callback in {"starting", "update"}:
            self._note_written()


MakeMischief = Callable[[], Mischief]
"""Function that returns the next fault to commit."""


CONTROLLERS = 4
"""Number of controllers of a thread."""
STOP_CYCLES = 3
"""Number of cycles within which a stop takes effect."""


class Disturbances:
    """Counts actions that may undo the actions of other threads."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._count = 0
        self._active = 0

    def __enter__(self) -> None:
        with self._lock:
            self._count += 1
            self._active += 1

    def __exit__(self, *_: object) -> None:
        with self._lock:
            self._active -= 1
            self._count += 1

    def stamp(self) -> int | None:
        """Return the count of begins and ends; None while an action is under way."""
        with self._lock:
            return None if self._active else self._count


class StormWorker:
    """Carries out random operations.

    Args:
        number: Number of the thread, from 0.
        seed: Seed of its random numbers.
        station: The station.
        observer: Checks every cycle.
        claims: Resources that controllers can claim.
        hooks: Answers of the robot's switching hooks.
        faults: Faults that begin or end in the robot between two cycles.
        disturbances: Counter of disturbances by all threads.

    Attributes:
        problems: Violated contracts.
        operations: Number of times each operation was carried out, by name.
        refusals: Number of refused operations, by the code of the error.
        switches: Number of switches, by outcome.
        mischiefs: Number of deliberate faults of controllers.
        busy: The present operation, and the time of its begin [s monotonic]; None
            between two operations.
        is_told_to_end: Set by the main thread.
    """

    def __init__(
        self,
        number: int,
        seed: int,
        station: Station,
        observer: SwitchObserver,
        *,
        claims: Sequence[Claim],
        hooks: HookScript,
        faults: Sequence[Callable[[random.Random], None]],
        disturbances: Disturbances,
    ) -> None:
        self.problems: list[str] = []
        self.operations: Counter[str] = Counter()
        self.refusals: Counter[str] = Counter()
        self.switches: Counter[str] = Counter()
        self.mischiefs = 0
        self.busy: tuple[str, float] | None = None
        self.is_told_to_end = False
        self._station = station
        self._manager = station.manager
        self._observer = observer
        self._claims = claims
        self._hooks = hooks
        self._faults = faults
        self._disturbances = disturbances
        self._dice = random.Random(seed)
        self._names = [f"storm_{number}_{index}" for index in range(CONTROLLERS)]
        self._menu: dict[str, tuple[int, Callable[[], None]]] = {
            "switch": (50, self._switch),
            "stop others": (4, self._stop_others),
            "load": (15, self._load),
            "unload": (8, self._unload),
            "mischief": (12, self._mischief),
            "stop": (2, self._stop),
            "release": (4, self._release),
            "reload": (1, self._reload),
            "recover": (2, self._recover),
            "robot fault": (2, self._robot_fault),
            "hardware": (2, self._hardware),
        }

    def run(self, operations: int) -> None:
        """Carry out random operations; end early if `is_told_to_end` is set.

        Args:
            operations: Number of operations.
        """
        names = list(self._menu)
        weights = [weight for weight, _ in self._menu.values()]
        for _ in range(operations):
            if self.is_told_to_end:
                return
            (name,) = self._dice.choices(names, weights)
            self.busy = (name, time.monotonic())
            self._carry_out(name)
            self.busy = None

    def _carry_out(self, name: str) -> None:
        try:
            self._menu[name][1]()
        except StationError as error:
            self.refusals[error.code] += 1
            if not error.message or not error.message.endswith("."):
                self._note(f"{name} was refused without a sentence: {error!r}")
        except Exception as error:  # noqa: BLE001 - what the storm is looking for
            self._note(f"{name} raised {type(error).__name__}: {error}")
        self.operations[name] += 1

    # Operations on own controllers

    def _switch(self) -> None:
        dice = self._dice
        # Take the stamp first, so that every action that stops one of these is counted.
        stamp = self._disturbances.stamp()
        running = self._running()
        idle = [name for name in self._names if name not in running]
        ours = [name for name in self._names if name in running]
        start = dice.sample(idle, dice.randint(0, min(2, len(idle))))
        stop = dice.sample(ours, dice.randint(0, len(ours)))
        if dice.random() < 0.05:
            start.append("storm_nobody")
        request = SwitchRequest(
            start,
            stop,
            dice.choice(list(Strictness)),
            start_asap=dice.random() < 0.3,
            timeout=dice.choice([0.0, 0.05, 0.2]),
            dry_run=dice.random() < 0.05,
        )
        # A switch that follows chains may also start and stop controllers of other
        # threads.
        is_wide = request.strictness.follows_chains
        try:
            with self._disturbances if is_wide else nullcontext():
                result = self._station.switch_controllers(request)
        except StationError as error:
            if not is_wide:
                self._look_at_refusal(request, running, error, stamp)
            raise
        if request.dry_run:
            return
        self._wait_for(result.cycle)
        self.switches[result.outcome.value if result.ok else "not ok"] += 1
        untruth = self._observer.untruth(result)
        if untruth is not None:
            self._note(f"the answer to {request} is not true: {untruth}")

    def _look_at_refusal(
        self,
        request: SwitchRequest,
        before: frozenset[str],
        error: StationError,
        stamp: int | None,
    ) -> None:
        self._wait_for(self._manager.cycle + 1)
        after = self._running()
        begun = {*request.start} & (after - before)
        lost = ({*request.stop} & before) - after
        unexplained = {
            name
            for name in lost
            if f"'{name}' could not be started again" not in error.message
            and not self._fault(name)
        }
        # Asked for last: another thread that starts a failed controller again takes its
        # fault away, and is counted.
        if not self._is_quiet_since(stamp):
            return
        for names, what in ((begun, "started"), (unexplained, "stopped")):
            if names:
                self._note(
                    f"refused ({error.message}), and {sorted(names)} were {what}"
                )

    def _load(self) -> None:
        dice = self._dice
        name = dice.choice(self._names)
        claim = dice.choice(self._claims)
        others = [one for one in self._listed() if one != name]
        chained = others and dice.random() < 0.4
        stamp = self._disturbances.stamp()
        self._station.load_controller(
            name,
            STORM_TYPE,
            {
                "interface": claim.interface,
                "resources": list(claim.resources),
                "reference": f"{dice.choice(sorted(others))}/value" if chained else "",
                "mischief": dice.random() < 0.05,
            },
        )
        if name not in self._listed() and self._is_quiet_since(stamp):
            self._note(f"loaded {name}, and it is not listed")

    def _unload(self) -> None:
        name = self._dice.choice(self._names)
        was_listed = name in self._listed()
        stamp = self._disturbances.stamp()
        try:
            self._station.unload_controller(name)
        except ControllerStateError:
            if name not in self._listed() and self._is_quiet_since(stamp):
                self._note(f"refused to unload {name}, and it is gone")
            raise
        if name in self._listed():
            self._note(f"unloaded {name}, and it is listed ({was_listed=})")

    def _mischief(self) -> None:
        dice = self._dice
        name = dice.choice(self._names)
        controller = self._manager.get_controller(name)
        if not isinstance(controller, StormController):
            self._note(f"{name} is {controller!r}")
            return
        commands = dice.choice([None, BAD_COMMANDS, BAD_COMMANDS, ODD_COMMANDS])
        callback = dice.choice(CALLBACKS)
        controller.mischief = Mischief(
            callback,
            None if commands is None else (dice.choice(commands),),
            intrudes=dice.random() < 0.4,
            place=dice.randrange(1000),
        )
        self.mischiefs += 1

    # Operations on everybody's

    def _stop_others(self) -> None:
        running = [info.name for info in self._manager.running()]
        stop = self._dice.sample(running, self._dice.randint(0, min(2, len(running))))
        with self._disturbances:
            result = self._station.switch_controllers(
                SwitchRequest(stop=stop, strictness=Strictness.BEST_EFFORT)
            )
        self._wait_for(result.cycle)
        untruth = self._observer.untruth(result)
        if untruth is not None:
            self._note(f"the answer to stopping {stop} is not true: {untruth}")

    def _stop(self) -> None:
        with self._disturbances:
            began = self._observer.cycle
            self._station.stop("The storm stops everything")
            # The stop was engaged before this cycle ended, so the cycle after the next
            # one has begun with it at the latest.
            cycle = self._observer.cycle + STOP_CYCLES
            self._wait_for(cycle)
            latch = self._station.loop.stop_latch
            # A stop that is pending now may be the next one, by another thread.
            if latch.pending and latch.cycle < began:
                self._note(f"a stop was not carried out by cycle {cycle}")

    def _release(self) -> None:
        self._station.release_stop(arm=False)
        self._station.release_stop(arm=True)

    def _reload(self) -> None:
        with self._disturbances:
            self._manager.reload_controller_libraries(
                force_kill=self._dice.random() < 0.5
            )

    def _recover(self) -> None:
        with self._disturbances:
            self._station.robots.recover_all(restart=self._dice.random() < 0.5)

    def _robot_fault(self) -> None:
        dice = self._dice
        with self._disturbances:
            if self._faults and dice.random() < 0.5:
                fault = partial(dice.choice(self._faults), dice)
                self._station.loop.run_in_cycle(fault, timeout=30.0)
            elif dice.random() < 0.5:
                self._hooks.begin(
                    prepare=dice.choice(["yes", "yes", "no", "raise"]),
                    works=dice.choices([True, False], [4, 1], k=5),
                    answers=dice.choices(
                        ["DONE", "ONGOING", "ERROR", "raise"], [4, 3, 1, 1], k=5
                    ),
                )
                self._wait_for(self._observer.cycle + 20)
                self._hooks.begin()
            else:
                self._hooks.begin()

    def _hardware(self) -> None:
        change = self._station.set_hardware_component_state
        name = self._dice.choice(self._manager.hardware_components()).name
        with self._disturbances:
            for state in [*ComponentState][self._dice.randint(0, 1) : 3]:
                change(name, state, stop_controllers=True)

    # Looking

    def _running(self) -> frozenset[str]:
        return self._observer.ran_at(self._observer.cycle)

    def _listed(self) -> set[str]:
        return {
            status.name
            for status in self._manager.list_controllers()
            if status.state is not ControllerState.LOADING
        }

    def _fault(self, name: str) -> str | None:
        return next(
            (s.fault for s in self._manager.list_controllers() if s.name == name),
            "it is not loaded",
        )

    def _is_quiet_since(self, stamp: int | None) -> bool:
        return stamp is not None and stamp == self._disturbances.stamp()

    def _wait_for(self, cycle: int) -> None:
        """Wait until the observer has checked a cycle; the main thread limits this."""
        while self._observer.cycle < cycle and not self.is_told_to_end:
            time.sleep(0.0002)

    def _note(self, problem: str) -> None:
        self.problems.append(problem)
