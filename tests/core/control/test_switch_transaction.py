"""Every way in which a switch can go: it commits, rolls back or halts, and says so.

The robot is two joints, alone or as two robots in one. Its answers to `prepare_switch`,
to `do_switch` (the switch itself, its reversal and any later one) and to
`switch_result` over three cycles, and the callback that raises, are enumerated. An
independent observer compares, at the end of every cycle, what the hardware was told,
who runs and what is commanded; and at the end the answer with what has happened.
"""

import contextlib
import itertools
from collections.abc import Iterator

import pytest

from station.core.clock import ManualClock
from station.core.control import switch_transaction
from station.core.control.controller_loader import TableLoader
from station.core.control.controller_manager import ControllerManager
from station.core.control.switching import Strictness, SwitchOutcome, SwitchRequest
from station.core.errors import StationError, SwitchRefusedError
from station.core.hardware.combined_robot_hw import CombinedRobotHW
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointHandle,
    JointStateHandle,
    VelocityJointInterface,
)
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters
from station.testing import HookScript, SwitchObserver
from station.testing.scripted import TYPES

PERIOD = 0.01
ROLLBACK = 20
RESULTS = ("DONE", "ONGOING", "ERROR", "raise")
CALLBACKS = ("starting", "stopping", "waiting", "aborting")
# The same end is reached whatever would have been answered afterwards.
ANSWERS = [
    ("DONE",),
    ("ERROR",),
    ("raise",),
    *[("ONGOING", last) for last in ("DONE", "ERROR", "raise")],
    *[("ONGOING", "ONGOING", last) for last in ("DONE", "ERROR", "raise", "ONGOING")],
]
PREPARES = ("yes", "no", "raise")
# Answers of do_switch to its first, second and third call.
DOES = list(itertools.product((True, False), repeat=3))
STRICTNESS = (Strictness.BEST_EFFORT, Strictness.STRICT)
# The others of ros2_control are strict once the request is planned.
REQUESTS = {
    "start": (["new"], []),
    "stop": ([], ["old"]),
    "hand over": (["new"], ["old"]),
    "hand over and more": (["new", "more"], ["old"]),
}


class Joint(RobotHW):
    """One joint; remembers in whose mode the hardware is."""

    def __init__(self, name: str, script: HookScript) -> None:
        super().__init__()
        self.name = name
        self.script = script
        self.modes: set[str] = set()
        self.effort, self.velocity = [0.0], [0.0]
        state = JointStateHandle(name, [0.0], [0.0], [0.0])
        efforts, velocities = EffortJointInterface(), VelocityJointInterface()
        efforts.register_handle(JointHandle(state, self.effort))
        velocities.register_handle(JointHandle(state, self.velocity))
        self.register_interface(efforts)
        self.register_interface(velocities)
        script.install(self)

    def do_switch(self, start, stop):
        self.modes -= {info.name for info in stop}
        self.modes |= {info.name for info in start}


class Bench:
    """The robot, the controllers old (running), new and more, and the observer."""

    def __init__(self, *, combined: bool, runs: bool, joints: int = 2) -> None:
        self.scripts = [HookScript() for _ in range(joints)]
        self.joints = [
            Joint(f"j{number}", script) for number, script in enumerate(self.scripts)
        ]
        robot = CombinedRobotHW(lambda _: RobotHW())
        for joint in self.joints if combined else self.joints[:1]:
            robot.add_robot(joint.name, joint)
        self.parameters = Parameters()
        self.manager = ControllerManager(
            robot, self.parameters, [TableLoader(TYPES)], ManualClock()
        )
        self.manager.pump = self.step
        self.time = 0.0
        both = ["j0", "j1"] if combined else ["j0"]
        self.claims = {"old": both, "new": ["j0"], "more": ["j1"]}
        self.load("old", "Effort", both)
        self.load("new", "Velocity", ["j0"])
        if combined:
            # `more` shares nothing with `new`: it takes the second joint alone.
            self.load("more", "Velocity", ["j1"])
        self.observer = SwitchObserver(robot, self.manager)
        if runs:
            self.switch(["old"], [])

    def load(self, name: str, kind: str, joints: list[str]) -> None:
        self.parameters.set(name, {"type": f"test/{kind}", "joints": joints})
        self.manager.load_controller(name)

    def switch(self, start, stop, **rest):
        request = SwitchRequest(start, stop, timeout=0.05, **rest)
        return self.manager.switch_controller(request)

    def step(self) -> None:
        self.time += PERIOD
        self.manager.update(self.time, PERIOD)
        self.observer.look()

    def running(self) -> set[str]:
        """Return the names; the statistics of `list_controllers` cost much more."""
        return {c.name for c in self.manager.conditions() if c.state.value == "running"}

    def faults(self) -> dict[str, str | None]:
        return {c.name: c.fault for c in self.manager.conditions()}

    def told(self) -> set[tuple[str, str]]:
        """Return which controller's mode each joint's hardware is in."""
        return {(j.name, mode) for j in self.joints for mode in j.modes}

    def expected(self) -> set[tuple[str, str]]:
        """Return which mode it ought to be in."""
        running = self.running()
        owned = ((joint.name, name) for joint in self.joints for name in running)
        return {(joint, name) for joint, name in owned if joint in self.claims[name]}


def cases() -> Iterator[tuple[object, ...]]:
    for combined, request, strictness, asap in itertools.product(
        (False, True), REQUESTS, STRICTNESS, (False, True)
    ):
        if request == "hand over and more" and not combined:
            continue
        asked = (combined, request, strictness, asap)
        for prepare in PREPARES:
            if prepare != "yes":
                yield *asked, prepare, (True,), ("DONE",), ""
                continue
            for answered in itertools.product(DOES, ANSWERS, ("", *CALLBACKS)):
                yield *asked, prepare, *answered


def choices(case: tuple[object, ...]) -> dict[tuple[str, object], object]:
    """Return all questions to the robot and the callbacks of a case, with answers.

    `ANSWERS` have three cycles at most, and the last answer is repeated.
    """
    does, answers, failing = case[5:]
    return {
        **{("works", n): works for n, works in enumerate((*does, True, True)[:3])},
        **{("answer", n): (*answers, *answers[-1:] * 2)[n] for n in range(3)},
        **{("raises", callback): callback == failing for callback in CALLBACKS},
    }


def try_all(
    tried: list[tuple[object, ...]],
) -> tuple[int, dict[tuple[object, ...], str]]:
    """Carry out cases; return the number of different runs, and what is wrong.

    Two cases are one run if they agree in all that the first one was asked for: what
    follows a refusal, for example, is asked of nobody.
    """
    runs: dict[tuple[object, ...], list[dict[tuple[str, object], object]]] = {}
    wrong = {}
    for case in tried:
        alike, chosen = runs.setdefault(case[:5], []), choices(case)
        if any(asked.items() <= chosen.items() for asked in alike):
            continue
        problem, asked_for = check(case)
        alike.append({key: chosen[key] for key in asked_for & chosen.keys()})
        if problem:
            wrong[case] = problem
    return sum(map(len, runs.values())), wrong


def check(
    case: tuple[object, ...],
) -> tuple[str | None, set[tuple[str, object]]]:
    """Carry out one case; return what is wrong, and which choices were asked for."""
    combined, request, strictness, asap, prepare, does, answers, failing = case
    bench = Bench(combined=bool(combined), runs=request != "start")
    start, stop = REQUESTS[str(request)]
    controllers = [bench.manager.get_controller(name) for name in bench.faults()]
    for controller in controllers:
        controller.calls.clear()
        if failing:
            controller.actions[failing] = lambda: 1 / 0
    # Of two robots only the first misbehaves: the other must not be forgotten.
    script = bench.scripts[0]
    script.begin(prepare, [*does, True], answers)
    before, cycle = bench.running(), bench.manager.cycle
    error = result = None
    try:
        result = bench.switch(start, stop, strictness=strictness, start_asap=asap)
    except StationError as refusal:
        error = refusal
    # A robot is asked twice for the same answer.
    asked = {("answer", n) for n in range((script.asked + 1) // 2)}
    # A hardware that answers again afterwards must not wake a switch that has ended.
    script.answers = ["DONE"]
    bench.step()
    asked |= {("works", n) for n in range(script.switches)}
    asked |= {("raises", call) for one in controllers for call in one.calls}
    cycles = bench.manager.cycle - cycle
    return _judge(bench, case, before, cycles, result, error), asked


def _judge(bench, case, before, cycles, result, error) -> str | None:
    request, prepare = case[1], case[4]
    start, stop = REQUESTS[request]
    running = bench.running()
    if bench.observer.problems:
        return bench.observer.problems[0]
    if cycles > ROLLBACK + 20:
        return f"it took {cycles} cycles"
    unreleased = {
        n for n, f in bench.faults().items() if "may still be in its mode" in (f or "")
    }
    strange = {name for _, name in bench.told() ^ bench.expected()}
    if strange - unreleased:
        return f"the hardware is in {bench.told()} and not told so"
    if prepare != "yes":
        return None if error and running == before else "prepare_switch was ignored"
    if error is not None:
        told = "could not be started again" in error.message
        return None if running == before or told else f"refused, and {running} run"
    wanted = (before - {*stop}) | {*start}
    return _judge_answer(case, before, running, wanted, unreleased, result)


def _judge_answer(case, before, running, wanted, unreleased, result) -> str | None:
    strictness, asap, failing = *case[2:4], case[7]
    start, stop = REQUESTS[case[1]]
    if result.ok != (running == wanted and not (unreleased & {*start, *stop})):
        return f"ok={result.ok}, and {running} run instead of {wanted}"
    if {*result.started} != {*start} & running:
        return f"started={result.started}, and {running} run"
    if {*result.stopped} != {*stop} - running:
        return f"stopped={result.stopped}, and {running} run"
    if not result.ok and not result.failed:
        return "not ok, and nothing has failed"
    if result.outcome is SwitchOutcome.ROLLED_BACK and running != before:
        return f"rolled back, and {running} run instead of {before}"
    strict = strictness is Strictness.STRICT and not asap
    committed = result.outcome is SwitchOutcome.COMMITTED
    if strict and start and stop and committed and not result.ok and not failing:
        return "strict, and committed in part"
    return None


@pytest.fixture(autouse=True)
def quick_to_give_up(monkeypatch):
    """Let the hardware have few cycles to take a switch back."""
    monkeypatch.setattr(switch_transaction, "ROLLBACK_CYCLES", ROLLBACK)


@pytest.mark.parametrize("request_", REQUESTS)
@pytest.mark.parametrize(
    "combined", [False, pytest.param(True, marks=pytest.mark.long)]
)
def test_every_switch_commits_rolls_back_or_halts_and_says_so(combined, request_):
    tried = [case for case in cases() if case[0] is combined and case[1] == request_]

    runs, wrong = try_all(tried)

    assert wrong == {}
    assert runs >= min(60, len(tried))


def test_every_fifth_switch_of_two_robots_does_too():
    tried = [case for case in cases() if case[0]][::5]

    runs, wrong = try_all(tried)

    assert wrong == {}
    assert runs > 300


def test_the_model_tries_every_combination():
    assert len(list(cases())) == 11_256


@pytest.mark.parametrize("failing", ["new", "more", "third"])
def test_all_that_have_begun_are_stopped_when_another_fails_to_start(failing):
    bench = Bench(combined=True, runs=True, joints=3)
    bench.claims["third"] = ["j2"]
    bench.load("third", "Velocity", ["j2"])
    bench.manager.get_controller(failing).actions["starting"] = lambda: 1 / 0

    with pytest.raises(StationError, match=f"'{failing}'"):
        bench.switch(["new", "more", "third"], ["old"])
    bench.step()

    assert bench.running() == {"old"}
    assert bench.told() == bench.expected()
    assert bench.observer.problems == []


@pytest.mark.parametrize("request_", [([], []), (["nobody"], [])])
def test_a_switch_of_nothing_that_the_robot_does_not_carry_out_is_refused(request_):
    bench = Bench(combined=False, runs=True)
    bench.scripts[0].begin(works=[False])

    with pytest.raises(SwitchRefusedError, match="starts and stops nothing"):
        bench.switch(*request_, strictness=Strictness.BEST_EFFORT)

    assert bench.running() == {"old"}


@pytest.mark.parametrize("does", [[False, True], [True]])
def test_a_controller_that_fails_before_its_switch_is_not_taken_back(does):
    bench = Bench(combined=False, runs=True)
    # Released in the update, in the cycle of the switch that was to stop it.
    bench.manager.get_controller("old").actions["update"] = lambda: 1 / 0
    bench.manager.get_controller("new").actions["starting"] = lambda: 1 / 0
    bench.scripts[0].begin(works=[True, *does])

    with contextlib.suppress(StationError):
        bench.switch(["new"], ["old"])
    bench.step()

    assert bench.running() == set()
    assert bench.told() == set()
    assert bench.observer.problems == []


def test_a_controller_that_fails_while_others_wait_is_not_started_again():
    bench = Bench(combined=True, runs=False)
    bench.scripts[1].begin(answers=[*["ONGOING"] * 4, "DONE"])
    bench.manager.get_controller("new").actions["update"] = lambda: 1 / 0

    result = bench.switch(["new", "more"], [], start_asap=True)

    assert bench.running() == {"more"}
    assert bench.told() == {("j1", "more")}
    assert not result.ok
    assert "update raised ZeroDivisionError" in result.failed["new"]
    assert result.started == ("more",)


def test_who_failed_before_the_switch_began_is_named_when_it_is_taken_back():
    bench = Bench(combined=False, runs=True)
    bench.manager.get_controller("old").actions["update"] = lambda: 1 / 0
    # The release of `old` works, the switch does not, taking it back does.
    bench.scripts[0].begin("yes", [True, False, True])

    result = bench.switch(["new"], ["old"], strictness=Strictness.BEST_EFFORT)

    assert result.outcome is SwitchOutcome.ROLLED_BACK
    assert bench.running() == set()
    assert "division by zero" in result.failed["old"]
    assert bench.observer.untruth(result) is None
