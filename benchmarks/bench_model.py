"""What the state and the model of an arm cost, and each step of its moving hand.

Run `python benchmarks/bench_model.py [--mode both] [--json]`. The arm moves, so every
call finds another configuration. A whole model is what a controller of torques asks for
in a cycle: mass matrix, Coriolis torques, gravity and the Jacobian of the end effector.
A step of the hand is its smooth motion (Ruckig), the look-ahead up to rest, and the
inverse kinematics of the arm; a commanded pose is that again with all that the arm
checks of it. Low quantiles of single calls count.
"""

import argparse
import json
import os
import sys
from collections.abc import Callable, Iterator
from time import perf_counter

from bench_cycle import MODES, measure_both
from cycle_scenarios import make_panda
from measuring import print_table, print_title
from paired_timing import ask_for_processor, low

from station.compiled import SWITCH, status
from station.controllers.cartesian_motion import CartesianJogController
from station.core.control.switching import SwitchRequest
from station.core.facade.station import Station
from station.core.franka import (
    Frame,
    FrankaModelHandle,
    FrankaModelInterface,
    FrankaStateHandle,
    FrankaStateInterface,
)
from station.hw.franka.arm.arm_limits import PANDA_LIMITS
from station.hw.franka.arm.franka_kinematics import CHAIN
from station.hw.franka.simulated.arm_parts import new_joint_memory
from station.hw.franka.simulated.cartesian_step import (
    CartesianStep,
    InverseKinematics,
)
from station.hw.franka.simulated.desired_motion import DesiredMotion
from station.hw.franka.simulated.motion_check import MotionCheck
from station.memory.doubles import put, zeros

STEPS = 2000
PERIOD = 0.001
JOG = "cartesian_jog_controller"
TWIST = [0.03, 0.02, -0.02, 0.0, 0.1, 0.0]
"""How the hand moves [m/s, rad/s]."""

Row = dict[str, object]


def measure_here() -> Iterator[Row]:
    """Measure in the mode of this process.

    Raises:
        RuntimeError: The station has no arm, or its hand cannot move as it has to.
        TypeError: The default configuration has another controller of that name.
    """
    ask_for_processor()
    station = make_panda()
    hw = station.loop.hw
    states, models = hw.get(FrankaStateInterface), hw.get(FrankaModelInterface)
    if states is None or models is None:
        raise RuntimeError("the station has no Franka arm")
    state, model = states.get_handle("panda_robot"), models.get_handle("panda_model")
    station.loop.step(100)
    yield from _of_state(station, state, model)
    station.switch_controllers(SwitchRequest(start=[JOG]))
    station.loop.step(100)
    controller = station.manager.get_controller(JOG)
    if not isinstance(controller, CartesianJogController):
        raise TypeError(f"{JOG} is no controller that jogs a hand")
    yield from _of_hand(controller)


def _of_state(
    station: Station, state: FrankaStateHandle, model: FrankaModelHandle
) -> Iterator[Row]:
    """Read state and model after each cycle of an arm that moves a little."""

    def read() -> object:
        return state.get_robot_state()

    def whole() -> object:
        return (
            model.get_mass(),
            model.get_coriolis(),
            model.get_gravity(),
            model.get_zero_jacobian(Frame.END_EFFECTOR),
        )

    q = state.get_robot_state().doubles("q")

    def turn(number: int) -> None:
        station.loop.step(1)
        q[3] += 1e-6 * (number % 7)

    yield _row("state of an arm", _times(read, turn))
    yield _row("model of an arm", _times(whole, turn))


def _of_hand(controller: CartesianJogController) -> Iterator[Row]:
    """Advance the motion of a hand, look ahead, and solve for the joints.

    Raises:
        RuntimeError: The hand meets an obstacle, or the arm does not follow it.
    """
    generator, lookahead = controller.generator, controller.lookahead
    state = controller.handle.get_robot_state().copy()
    memory, limits = new_joint_memory(state), PANDA_LIMITS
    check = MotionCheck(memory, limits, PERIOD)
    hand = CartesianStep(memory, check, state.doubles, CHAIN, PERIOD)
    follow = DesiredMotion(
        memory,
        lower=limits.lower,
        upper=limits.upper,
        deceleration=limits.acceleration,
        period=PERIOD,
    ).follow_positions
    q_d, tool, target = state.doubles("q_d"), state.doubles("F_T_EE"), zeros(16)
    kinematics = InverseKinematics(CHAIN, q_d, tool, target, zeros(7))
    state.O_T_EE_c = generator.pose
    put(state.doubles("elbow_c")[:1], state.q_d[2:3])
    hand.size = 16
    # The arm that looks ahead is the one whose joints are solved for.
    lookahead.start(state)
    generator.go_at(TWIST)
    advances, looks, solutions, commands = [], [], [], []
    for number in range(STEPS):
        if number % 200 == 0:
            generator.go_at([value * (-1) ** (number // 200) for value in TWIST])
        begin = perf_counter()
        generator.advance(PERIOD)
        moved = perf_counter()
        passes = lookahead.passes(generator)
        looked = perf_counter()
        if not passes and not lookahead.allows(generator):
            raise RuntimeError(f"the hand meets an obstacle: {lookahead.obstacle}")
        hand.command[:] = target[:] = generator.pose
        asked = perf_counter()
        kinematics.advance(q_d[2])
        known = perf_counter()
        violations = hand.follow_command(False, True)  # noqa: FBT003 - C functions
        end = perf_counter()
        if violations:
            raise RuntimeError(f"the arm does not follow in step {number}")
        follow()
        advances.append((moved - begin) * 1e6)
        looks.append((looked - moved) * 1e6)
        solutions.append((known - asked) * 1e6)
        commands.append((end - known) * 1e6)
    yield _row("smooth motion of a hand", advances)
    yield _row("inverse kinematics and look-ahead", _sums(looks, solutions))
    yield _row("commanded pose of a hand", commands)


def _sums(first: list[float], second: list[float]) -> list[float]:
    return [one + other for one, other in zip(first, second, strict=True)]


def _times(action: Callable[[], object], turn: Callable[[int], None]) -> list[float]:
    times = []
    for number in range(STEPS):
        turn(number)
        begin = perf_counter()
        action()
        times.append((perf_counter() - begin) * 1e6)
    return times


def _row(what: str, times: list[float]) -> Row:
    return {"what": what, "mode": status().mode, "us": round(low(times), 2)}


def main() -> None:
    """Print the table, or JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mode", choices=["both", *MODES], default="both")
    parser.add_argument("--json", action="store_true", help="print rows as JSON")
    options = parser.parse_args()
    if options.mode == "both":
        found = list(measure_both([], __file__))
    else:
        if os.environ.get(SWITCH) != MODES[options.mode]:
            os.environ[SWITCH] = MODES[options.mode]
            os.execv(sys.executable, [sys.executable, *sys.argv])
        found = list(measure_here())
    if options.json:
        sys.stdout.write(json.dumps(found, indent=1) + "\n")
        return
    print_title("State and model of an arm, and a step of its hand [us]")
    print_table(list(found[0]), [list(row.values()) for row in found])


if __name__ == "__main__":
    main()
