"""The bench moves one joint of the robot within an envelope, and says how it followed.

The robot is the simulated Panda; waiting steps its loop.
"""

import re
from pathlib import Path

import numpy as np
import pytest

import station.ui
from station.app.composition import compose
from station.config import load_config
from station.core.control.switching import SwitchRequest
from station.core.errors import (
    ControllerStateError,
    InvalidCommandError,
    StoppedError,
)
from station.trials.errors import (
    BenchRefusedError,
    ExperimentError,
    ImpossibleRangeError,
    UnknownParameterError,
)
from station.trials.live_bench import LiveBench
from station.wire.excitations import BenchRequest, Chirp, Multisine, Relay, Sine, Step

GROUP = "effort_group_position_controller"
TRAJECTORY = "effort_joint_trajectory_controller"
JOINT = "panda_joint7"
STEP = Step(joint=JOINT, amplitude=0.1, at=0.05)


PAGE = Path(station.ui.__file__).parent / "static" / "panels" / "bench.js"
TEXT = PAGE.read_text("utf-8")
DEFAULTS = {
    name: float(value)
    for name, value in re.findall(
        r"(\w+): (?:field|angleField)\(\"[^\"]+\", \"?([\d.]+)", TEXT
    )
}
"""What stands in the fields of the dock Tuning before anybody types."""
(LINE,) = re.findall(r"SIZES = \{(.*)\}", TEXT)
SIZES = {name: float(value) for name, value in re.findall(r"(\w+): ([\d.]+)", LINE)}
"""The size with which each kind of test begins."""
(LINE,) = re.findall(r"TIMES = \{(.*)\}", TEXT)
TIMES = {name: float(value) for name, value in re.findall(r"(\w+): ([\d.]+)", LINE)}
"""How long each kind of test lasts at first [s]."""


@pytest.fixture(scope="module")
def panda():
    """A station that steps by hand; its arm is ideal, so that steps end on target."""
    return compose(load_config({"robot": {"realism": "ideal"}})).station


@pytest.fixture
def station(panda):
    """The station at its beginning, with the group controller running."""
    panda.simulation.reset()
    panda.loop.step(10)
    use(panda, GROUP)
    return panda


def use(station, name):
    """Let one controller run."""
    running = [c.name for c in station.controllers() if c.state.value == "running"]
    if name not in running:
        station.switch_controllers(SwitchRequest(start=(name,), stop=tuple(running)))
    station.loop.step(5)


def free():
    """Admit every command."""


@pytest.fixture
def bench(station):
    """The bench whose waiting makes time pass."""
    return LiveBench(station, sleep=lambda _: station.loop.step(2), now=lambda: 0.0)


def ask(excitation, duration=0.5):
    return BenchRequest(excitation=excitation, duration=duration)


def test_a_step_is_followed_and_taken_back(bench, station):
    before = station.latest().position[6]

    found = bench.measure(GROUP, ask(STEP, 0.8), free)

    assert (found.joint, found.kind, found.cycles, found.lost) == (
        *(JOINT, "step"),
        *(800, 0),
    )
    desired, position = np.array(found.desired), np.array(found.position)
    assert desired[-1] == pytest.approx(before + 0.1)
    assert position[-1] == pytest.approx(before + 0.1, abs=0.005)
    # The rise by hand, from the same curve.
    way = (position - before) / 0.1
    time = np.array(found.time)
    rise = time[np.argmax(way >= 0.9)] - time[np.argmax(way >= 0.1)]
    assert found.metrics["rise_time"] == pytest.approx(rise, abs=0.005)
    assert found.gains == dict(station.tuning.gains(GROUP).values)
    station.loop.step(500)
    assert station.latest().position[6] == pytest.approx(before, abs=0.005)


@pytest.mark.parametrize(
    "excitation",
    [
        Sine(joint=JOINT, amplitude=0.05, frequency=2.0),
        Chirp(joint=JOINT, amplitude=0.02, first=1.0, last=5.0),
        Multisine(joint=JOINT, amplitude=0.05, frequencies=(1.0, 2.0)),
        Relay(joint=JOINT, amplitude=0.05),
    ],
    ids=lambda one: one.kind,
)
def test_every_excitation_moves_the_joint_alone(bench, station, excitation):
    before = station.latest().position

    found = bench.measure(GROUP, ask(excitation), free)

    assert max(map(abs, np.array(found.desired) - before[6])) > 0.01
    assert found.metrics["rms_error"] > 0.0
    after = station.latest().position
    assert after[:6] == pytest.approx(before[:6], abs=1e-3)


def test_a_trajectory_controller_follows_what_has_no_jumps(bench, station):
    use(station, TRAJECTORY)
    sine = Sine(joint=JOINT, amplitude=0.05, frequency=2.0)

    assert bench.measure(TRAJECTORY, ask(sine), free).metrics["rms_error"] < 0.01
    with pytest.raises(ExperimentError, match="no jumps; the script has a step"):
        bench.measure(TRAJECTORY, ask(STEP), free)


@pytest.mark.parametrize(
    ("excitation", "error", "match"),
    [
        (Step(joint=JOINT, amplitude=0.31), ImpossibleRangeError, "would go 0.31 rad"),
        (
            Sine(joint=JOINT, amplitude=0.3, frequency=3.0),
            ImpossibleRangeError,
            r"rad/s; allowed are 1 rad/s",
        ),
        (Step(joint=JOINT, amplitude=0.0), ImpossibleRangeError, "moves nothing"),
        (Step(joint=JOINT, amplitude=0.1, at=9.0), ImpossibleRangeError, "nothing"),
        (Relay(joint=JOINT, amplitude=0.4), ImpossibleRangeError, "would go 0.4 rad"),
        (Step(joint="nobody", amplitude=0.1), UnknownParameterError, "'nobody'"),
    ],
)
def test_what_would_leave_the_envelope_is_refused(
    bench, station, excitation, error, match
):
    before = station.loop.cycle

    with pytest.raises(error, match=match):
        bench.measure(GROUP, ask(excitation), free)

    assert station.loop.cycle == before


def test_a_joint_near_its_limit_may_only_go_away_from_it(bench, station):
    station.simulation.reset({JOINT: 2.8})  # it ends at 2.8973
    station.loop.step(10)

    with pytest.raises(ImpossibleRangeError, match=r"would go from 2\.800 to 2\.900"):
        bench.measure(GROUP, ask(STEP), free)
    away = Step(joint=JOINT, amplitude=-0.1)
    assert bench.measure(GROUP, ask(away), free).cycles == 500


def test_controllers_that_do_not_run_or_take_no_positions_are_refused(bench, station):
    with pytest.raises(ControllerStateError, match="not running"):
        bench.measure(TRAJECTORY, ask(STEP), free)
    use(station, "velocity_group_controller")
    with pytest.raises(InvalidCommandError, match="takes no positions"):
        bench.measure("velocity_group_controller", ask(STEP), free)


def test_a_robot_that_moves_is_not_measured(bench, station):
    values = list(station.latest().position)
    values[0] += 0.3
    station.motion.set_command(GROUP, values)
    station.loop.step(100)

    with pytest.raises(BenchRefusedError, match="'panda_joint1' moves"):
        bench.measure(GROUP, ask(STEP), free)


def test_a_stop_ends_the_measurement(station):
    def wait(_):
        station.loop.step(50)
        station.stop("a test")
        station.loop.step(1)

    with pytest.raises(StoppedError):
        LiveBench(station, sleep=wait, now=lambda: 0.0).measure(GROUP, ask(STEP), free)
    station.release_stop(arm=False)
    station.release_stop(arm=True)


def test_who_loses_control_moves_nothing_any_more(bench, station):
    admitted = []

    def admit():
        admitted.append(station.loop.cycle)
        if len(admitted) > 5:
            raise StoppedError("Somebody else has taken control.")

    with pytest.raises(StoppedError, match="Somebody else"):
        bench.measure(GROUP, ask(STEP), admit)
    assert len(admitted) == 6


def test_a_joint_that_runs_away_is_led_back(station):
    def wait(_):
        station.loop.step(2)
        world.data.qpos[6] += next(turns, 0.0)  # something turns the joint by force

    turns = iter([0.1] * 5)
    world = station.loop.hw.simulated_world().world
    before = station.latest().position[6]
    bench = LiveBench(station, sleep=wait, now=lambda: 0.0)

    with pytest.raises(BenchRefusedError, match=r"'panda_joint7' was .* away"):
        bench.measure(GROUP, ask(STEP), free)
    assert station.motion.set_point(GROUP).values[6] == pytest.approx(before, abs=1e-6)


@pytest.fixture(scope="module")
def typical():
    """A station whose arm measures and rubs as a real one does."""
    return compose(load_config()).station


def default(kind, joint):
    """Return what the dock asks for while nothing was typed."""
    fields = {"step": (), "relay": ("hysteresis",)} | {
        "sine": ("frequency",),
        "chirp": ("first", "last"),
    }
    kinds = {"step": Step, "sine": Sine, "chirp": Chirp, "relay": Relay}
    given = {name: DEFAULTS[name] for name in fields[kind]}
    return BenchRequest(
        excitation=kinds[kind](joint=joint, amplitude=SIZES[kind], **given),
        duration=TIMES[kind],
    )


@pytest.mark.long
@pytest.mark.parametrize("kind", ["step", "sine", "chirp", "relay"])
@pytest.mark.parametrize(
    "controller",
    [
        GROUP,
        "position_group_controller",
        "position_streaming_controller",
        TRAJECTORY,
        "position_joint_trajectory_controller",
    ],
)
def test_the_defaults_of_the_page_trip_no_joint(typical, controller, kind):
    if "trajectory" in controller and kind in {"step", "relay"}:
        pytest.skip("A trajectory has no jumps: it is refused before anything moves.")
    bench = LiveBench(typical, sleep=lambda _: typical.loop.step(4), now=lambda: 0.0)
    for number in range(1, 8):
        typical.simulation.reset()
        typical.loop.step(100)
        use(typical, controller)
        bench.measure(controller, default(kind, f"panda_joint{number}"), free)
        typical.loop.step(100)
        assert typical.latest().mode == "move"


@pytest.mark.parametrize("cycles", [2, 10])
@pytest.mark.parametrize("controller", [GROUP, "position_group_controller"])
def test_a_joint_that_answers_too_fast_is_braked_before_the_arm_trips(
    station, controller, cycles
):
    use(station, controller)
    before = station.latest().position[0]
    fastest = []

    def wait(_):
        station.loop.step(cycles)
        fastest.append(abs(station.latest().velocity[0]))

    bench = LiveBench(station, sleep=wait, now=lambda: 0.0)
    relay = Relay(joint="panda_joint1", amplitude=0.3, hysteresis=0.005)
    with pytest.raises(BenchRefusedError, match=r"moved with .* 80% of its velocity"):
        bench.measure(controller, ask(relay, 2.0), free)
    assert max(fastest) < 2.175
    station.loop.step(500)
    assert station.latest().mode == "move"
    assert station.latest().position[0] == pytest.approx(before, abs=0.01)


def test_time_that_does_not_pass_ends_the_measurement(station):
    clock = iter(range(100))
    bench = LiveBench(station, sleep=lambda _: None, now=lambda: float(next(clock)))

    with pytest.raises(BenchRefusedError, match="cycles are too slow"):
        bench.measure(GROUP, ask(STEP), free)


def test_one_measurement_is_done_at_a_time(station):
    refused = []

    def wait(_):
        if not refused:
            with pytest.raises(BenchRefusedError, match="under way") as caught:
                bench.measure(GROUP, ask(STEP), free)
            refused.append(caught)
        station.loop.step(2)

    bench = LiveBench(station, sleep=wait, now=lambda: 0.0)
    bench.measure(GROUP, ask(STEP, 0.2), free)

    assert refused


RELAY = Relay(joint=JOINT, amplitude=0.05, hysteresis=0.0005)


def test_a_relay_of_p_alone_proposes_gains_and_leaves_those_in_force(bench, station):
    before = dict(station.tuning.gains(GROUP).values)

    request = BenchRequest(excitation=RELAY, duration=3.0, relay_gain=15.0)
    found = bench.measure(GROUP, request, free)

    assert found.gains[f"{JOINT}/p"] == 15.0
    assert found.gains[f"{JOINT}/d"] == 0.0
    assert dict(station.tuning.gains(GROUP).values) == before
    ku, tu = found.metrics["ultimate_gain"], found.metrics["ultimate_period"]
    rules = {one.rule: one.gains for one in found.proposals}
    assert rules["ziegler_nichols_pid"][f"{JOINT}/p"] == pytest.approx(0.6 * ku, 1e-3)
    derivative = rules["ziegler_nichols_pid"][f"{JOINT}/d"]
    assert derivative == pytest.approx(0.6 * ku * tu / 8.0, 1e-3)
    assert "limited to 0" in found.proposals[-1].note


def test_a_relay_test_that_is_refused_puts_the_gains_back(bench, station):
    before = dict(station.tuning.gains(GROUP).values)
    # The ideal arm has no friction: with this gain its joint comes near its limit.
    request = BenchRequest(
        excitation=Relay(joint=JOINT, amplitude=0.1), duration=4.0, relay_gain=15.0
    )
    with pytest.raises(BenchRefusedError, match="of its velocity limit"):
        bench.measure(GROUP, request, free)
    assert dict(station.tuning.gains(GROUP).values) == before


def test_a_relay_in_a_loop_with_d_has_a_margin_and_proposes_nothing(bench):
    found = bench.measure(GROUP, ask(RELAY, 2.0), free)
    assert found.proposals == []
    assert "ultimate_gain" not in found.metrics
    assert found.metrics["gain_margin"] > 1.0


def test_a_relay_gain_is_for_relays_and_pids(bench, station):
    request = BenchRequest(excitation=STEP, relay_gain=15.0)
    with pytest.raises(ImpossibleRangeError, match="this is a step"):
        bench.measure(GROUP, request, free)
    use(station, "position_group_controller")
    with pytest.raises(ImpossibleRangeError, match="has no gain p"):
        bench.measure(
            "position_group_controller",
            BenchRequest(excitation=RELAY, relay_gain=15.0),
            free,
        )


def test_a_chirp_has_a_bode_plot_and_a_sine_its_gain(bench):
    chirp = Chirp(joint=JOINT, amplitude=0.02, first=0.5, last=8.0)

    found = bench.measure(GROUP, ask(chirp, 4.0), free)

    assert found.bode is not None
    assert len(found.bode.frequency) == len(found.bode.closed_loop.gain) > 20
    assert found.metrics["coherence"] > 0.9
    at = int(np.argmin(np.abs(np.array(found.bode.frequency) - 3.0)))
    sine = Sine(joint=JOINT, amplitude=0.02, frequency=3.0)
    single = bench.measure(GROUP, ask(sine, 3.0), free).metrics
    assert single["gain"] == pytest.approx(found.bode.closed_loop.gain[at], rel=0.05)
    assert single["phase"] == pytest.approx(found.bode.closed_loop.phase[at], abs=4)
