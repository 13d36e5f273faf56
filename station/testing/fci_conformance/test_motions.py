"""Checks that move the arm: every mode, the end of a motion, lost commands, rates."""

from dataclasses import replace
from itertools import product

import pytest

from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.fci.wire.robot_protocol import (
    Command,
    MoveController,
    MoveGenerator,
)
from station.testing.fci_conformance.dialog import (
    SUCCESS_RATE,
    Dialog,
    Outcome,
    Verdict,
)
from station.testing.fci_conformance.plugin import needs
from station.testing.fci_conformance.trajectories import (
    CARTESIAN,
    HOLD,
    JOINTS,
    START,
    Fields,
    State,
    along,
    farthest,
    glide,
    joint_positions,
    joint_velocities,
    poses,
    rate,
    rest,
    step,
    there_and_back,
    torques,
    twists,
)

pytestmark = pytest.mark.moves

TIME = 600
"""Cycles of a motion there and back."""
REST = 30

TURN, RISE = there_and_back(0.08, TIME), there_and_back(0.02, TIME)
"""Motion of joint 7 [rad], motion of the end effector up and down [m]."""
MOTIONS = {
    "joint position": joint_positions(along(6, TURN)),
    "joint velocity": joint_velocities(along(6, rate(TURN))),
    "cartesian position": poses(along(2, RISE, 3)),
    "cartesian position with an elbow": poses(along(2, RISE, 3), elbow=(0.0, 1.0)),
    "cartesian velocity": twists(along(2, rate(RISE), 6)),
}
MEANWHILE = {
    "second motion": (Command.MOVE, ()),
    "setting": (Command.SET_EE_TO_K, ("EE_T_K",)),
}
"""Requests that an arm refuses while it moves, with the fields to take from its state.
"""


@pytest.mark.parametrize(
    ("controller", "motion"),
    list(product((JOINTS, CARTESIAN), MOTIONS)),
    ids=lambda one: str(getattr(one, "name", one)).lower().replace("_", " "),
)
def test_motion_there_and_back(
    dialog: Dialog, controller: MoveController, motion: str
) -> Verdict:
    """The motion succeeds without errors, and ends within 0.02 rad of its start."""
    asked = replace(MOTIONS[motion], controller=controller)
    outcome = dialog.move(asked, TIME + REST)
    away, states = farthest(outcome.last["q"], START), outcome.states.values()
    fast = max(max(map(abs, state["dq_d"])) for state in states)
    # The states show the motion: the desired velocities are not zero.
    holds = outcome.is_clean and away < 0.02 and fast > 0.01
    return holds, f"{outcome}; {away:.2g} rad away, dq_d up to {fast:.2g} rad/s"


def test_motion_goes_where_it_is_told(dialog: Dialog) -> Verdict:
    """Joint 7 ends 0.08 rad from its start, within 0.01 rad."""
    outcome = dialog.move(glide((0, 0, 0, 0, 0, 0, 0.08), TIME), TIME + REST)
    moved = dialog.settle()["q"][6] - outcome.first["q"][6]
    holds = outcome.is_success and abs(moved - 0.08) < 0.01
    return holds, f"{outcome}; {moved:.4f} rad further"


def test_torques_hold_without_a_generator(dialog: Dialog) -> Verdict:
    """A motion of zero torques succeeds, and the arm stays within 0.2 rad."""
    outcome = dialog.move(torques(rest), 200)
    away = farthest(outcome.last["q"], START)
    return outcome.is_clean and away < 0.2, f"{outcome}; {away:.2g} rad away"


def test_torques_turn_a_joint(dialog: Dialog) -> Verdict:
    """A torque of 1 Nm turns joint 7 by more than 1 mrad within 0.3 s."""
    motion = torques(along(6, lambda n: min(n, 200, max(0, 400 - n)) / 200))
    outcome = dialog.move(motion, 400)
    moved = outcome.last["q"][6] - outcome.first["q"][6]
    return outcome.is_success and moved > 0.001, f"{outcome}; {moved:.4f} rad"


def test_motion_without_a_generator_is_refused_before_version_7(
    dialog: Dialog,
) -> Verdict:
    """The answer is invalid argument rejected."""
    needs(MoveGenerator.NONE not in dialog.protocol.generators)
    answer = dialog.start(torques(rest)).words
    return answer == "invalid argument rejected", answer


def test_arm_waits_for_the_first_command(dialog: Dialog) -> Verdict:
    """After 100 ms without a command the mode is move, and then the motion succeeds."""
    outcome = dialog.move(HOLD.without(lambda n: n < 100), 200)
    modes = {state["robot_mode"] for state in outcome.states.values()}
    holds = outcome.is_success and modes == {RobotMode.MOVE.value}
    return holds, f"{outcome}; modes {sorted(modes)}"


@pytest.mark.parametrize("asked", MEANWHILE)
def test_request_during_a_motion_is_refused(dialog: Dialog, asked: str) -> Verdict:
    """The answer is command not possible rejected, and the motion succeeds."""
    command, fields = MEANWHILE[asked]
    values = {name: dialog.state[name] for name in fields}
    outcome, answer = ask_meanwhile(dialog, command, values)
    holds = outcome.is_success and answer == "command not possible rejected"
    return holds, f"{answer}; the motion: {outcome}"


def test_stop_preempts_a_motion(dialog: Dialog) -> Verdict:
    """Move is answered with preempted, StopMove with success, and the arm is idle."""
    outcome, answer = ask_meanwhile(dialog, Command.STOP_MOVE, {})
    is_over = outcome.ended == "preempted" and answer == "success"
    mode = dialog.state["robot_mode"]
    seen = f"Move {outcome}, StopMove {answer}, robot mode {mode}"
    return is_over and mode == RobotMode.IDLE.value, seen


def ask_meanwhile(
    dialog: Dialog, command: Command, values: Fields
) -> tuple[Outcome, str]:
    """Send a request during a motion; return the motion's course, and the answer."""
    sent: list[int] = []

    def stream(cycle: int, *states: State) -> Fields | None:
        if cycle >= 100 and not sent:
            sent.append(dialog.client.send(command, values))
        return HOLD.stream(cycle, *states)

    outcome = dialog.move(replace(HOLD, stream=stream), 300)
    answer = dialog.client.take_answer(sent[0], 1.0) if sent else None
    return outcome, "no answer" if answer is None else answer.words


def test_success_rate_counts_the_commands_that_came(dialog: Dialog) -> Verdict:
    """The rate is the answered share of the last 100 states: all, or two of three."""
    motions = HOLD, HOLD.without(lambda n: n >= 50 and n % 3 == 0)
    outcomes = [dialog.move(motion, 310) for motion in motions]
    errors = [
        abs(state[SUCCESS_RATE] - sum(n - 100 <= m < n for m in outcome.sent) / 100)
        for outcome in outcomes
        for n, state in outcome.states.items()
        if n > 150
    ]
    off = max(errors, default=0.0)
    rates = ", ".join(f"{one.lowest_rate:.2f} ({one})" for one in outcomes)
    holds = all(one.is_success for one in outcomes) and off < 0.05
    return holds, f"{rates}; up to {off:.2f} from what was sent"


def test_some_lost_commands_in_a_row_are_no_error(dialog: Dialog) -> Verdict:
    """The motion succeeds although 15 commands in a row are left out."""
    outcome = dialog.move(HOLD.without(lambda n: 100 <= n < 115), 300)
    return outcome.is_clean, outcome


def test_hole_in_a_moving_joint_is_bridged(dialog: Dialog) -> Verdict:
    """The motion succeeds although 2 commands of a moving joint are left out."""
    motion, hole = MOTIONS["joint position"], TIME // 4
    outcome = dialog.move(motion.without(lambda n: 0 <= n - hole < 2), TIME + REST)
    return outcome.is_success, outcome


def test_errors_of_the_last_motion_are_forgotten_by_the_next(dialog: Dialog) -> Verdict:
    """After a motion without errors, last_motion_errors is empty."""
    dialog.move(joint_positions(along(6, step(0.5))), 100)
    dialog.go_to()
    outcome = dialog.move(HOLD, 100)
    return outcome.is_clean, outcome


def test_asynchronous_positions(dialog: Dialog) -> Verdict:
    """q_d reaches one goal 0.1 rad away within 1 mrad, and the motion succeeds."""
    fields = dialog.protocol.exchanges[Command.MOVE].request.offsets
    needs("use_async_motion_generator" in fields)
    goal = [q + 0.1 * (i == 6) for i, q in enumerate(START)]

    def is_reached(state: State) -> bool:
        is_still = max(map(abs, state["dq_d"])) < 0.01
        return is_still and farthest(state["q_d"], goal) < 1e-3

    def stream(cycle: int, state: State, _begin: State) -> Fields | None:
        if cycle == 10:
            return {"q_c": goal}
        is_over = cycle > 10 and (cycle >= 3000 or is_reached(state))
        return {"motion_generation_finished": True} if is_over else None

    asked = {"use_async_motion_generator": True, "maximum_velocity": (0.5,) * 7}
    outcome = dialog.move(replace(HOLD, stream=stream), 3000, **asked)
    reached = [n for n, state in outcome.states.items() if n > 10 and is_reached(state)]
    when = f"after {reached[0]} ms" if reached else "never"
    return bool(reached) and outcome.is_success, f"{outcome}; reached {when}"
