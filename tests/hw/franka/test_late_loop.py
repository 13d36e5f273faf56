"""What a late loop misses are lost packets, and no error by itself."""

from collections.abc import Callable

import pytest

from station.core.franka.franka_errors import error_names
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.franka_hw import FrankaHW
from tests.hw.franka.command_bench import Bench
from tests.hw.franka.test_franka_hw import PERIOD, ROBOT

SPEED = 0.2
RAMP = 1.0
Step = Callable[[Bench, float, float], None]


def travelled(time: float) -> tuple[float, float]:
    """Return way and speed of a motion that starts with a constant acceleration."""
    if time < RAMP:
        return 0.5 * SPEED / RAMP * time * time, SPEED * time / RAMP
    return SPEED * (time - 0.5 * RAMP), SPEED


def move_position(bench: Bench, way: float, _speed: float) -> None:
    bench.hw.commands.positions[0] = way


def move_velocity(bench: Bench, _way: float, speed: float) -> None:
    bench.hw.commands.velocities[0] = speed


def move_pose(bench: Bench, way: float, _speed: float) -> None:
    if not hasattr(bench, "rest"):
        bench.rest = bench.pose()
    bench.command_pose([*bench.rest[:13], bench.rest[13] + way, *bench.rest[14:]])


def move_twist(bench: Bench, _way: float, speed: float) -> None:
    bench.command_twist([0.0, speed, 0.0, 0.0, 0.0, 0.0])


def hold_with_torques(bench: Bench, _way: float, speed: float) -> None:
    bench.hw.commands.efforts[6] = 0.5 * speed


MOTIONS = [
    ("jp", move_position),
    ("jv", move_velocity),
    ("cp", move_pose),
    ("cv", move_twist),
    ("jt", hold_with_torques),
]


def make(**parameters: object) -> Bench:
    tree = ParameterTree({
        "robot": {
            **ROBOT,
            "rate_limiting": False,
            "cutoff_frequency": 1000.0,
            "supervisor": {"velocity_factor": 3.0},
            **parameters,
        }
    })
    hw = FrankaHW()
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    hw.read(0.0, PERIOD)
    return Bench(hw)


def run(bench: Bench, step: Step, late: int) -> None:
    """Move for 1.5 s; a cycle at full speed is late."""
    time = 0.0
    for cycle in range(1_500):
        cycles = 1 + late if cycle == 1_200 else 1
        time += cycles * PERIOD
        bench.hw.read(time, cycles * PERIOD)
        step(bench, *travelled(time))
        bench.hw.write(time, cycles * PERIOD)


@pytest.mark.parametrize("late", [1, 5, 19])
@pytest.mark.parametrize(("kind", "step"), MOTIONS)
def test_motion_goes_on_through_a_late_cycle(kind: str, step: Step, late: int) -> None:
    bench = make()
    bench.start(kind)
    run(bench, step, late)
    assert bench.hw.mode() == "move", bench.hw.arm.errors()


@pytest.mark.parametrize(("kind", "step"), MOTIONS)
def test_twenty_missed_cycles_raise_the_communication_error_alone(
    kind: str, step: Step
) -> None:
    bench = make()
    bench.start(kind)
    run(bench, step, 20)
    errors = error_names(bench.state.current_errors)
    assert errors == ["communication_constraints_violation"]


@pytest.mark.parametrize("late", [20, 300])
def test_world_waits_for_a_very_late_loop_if_real_time_is_ignored(late: int) -> None:
    bench = make(realtime_config="ignore")
    bench.start("jv")
    run(bench, move_velocity, late)
    assert bench.hw.mode() == "move"
    assert bench.state.time == pytest.approx(1.5 + 0.019, abs=2e-3)


def test_missed_cycles_show_in_the_success_rate() -> None:
    bench = make()
    bench.start("jp")
    for cycle in range(250):
        bench.hw.write(0.0, PERIOD)
        bench.hw.read(0.0, 11 * PERIOD if cycle == 249 else PERIOD)
    assert bench.state.control_command_success_rate == pytest.approx(0.9)


def test_time_waits_as_long_as_the_world() -> None:
    assert make().hw.simulated_world().longest_period() == float("inf")
    waiting = make(realtime_config="ignore").hw
    assert waiting.simulated_world().longest_period() == pytest.approx(0.020)
    waiting.check_period(0.05)
    assert waiting.simulated_world().longest_period() == pytest.approx(0.069)
