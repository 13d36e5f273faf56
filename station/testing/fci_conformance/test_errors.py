"""Checks that provoke each error by its cause, read its name, and recover at once.

The same cause may raise further errors, which each case lists; any other error is a
failure. Source: Franka Control Interface documentation, Errors, and Robot and interface
specifications; libfranka@0.15.0 include/franka/errors.h.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, nan

import pytest

from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.fci.wire.robot_protocol import Command
from station.testing.fci_conformance.dialog import Dialog, Verdict
from station.testing.fci_conformance.plugin import Row
from station.testing.fci_conformance.trajectories import (
    HOLD,
    QUIET,
    START,
    Motion,
    along,
    farthest,
    glide,
    joint_positions,
    joint_velocities,
    poses,
    ramp,
    rest,
    step,
    torques,
    twists,
)

pytestmark = pytest.mark.moves

JOINT = "joint_motion_generator"
END_EFFECTOR = "cartesian_motion_generator"
JUMPS = (f"{JOINT}_velocity_discontinuity", f"{JOINT}_acceleration_discontinuity")
SOLVED_JUMPS = (
    f"{END_EFFECTOR}_velocity_discontinuity",
    f"{END_EFFECTOR}_acceleration_discontinuity",
    f"{END_EFFECTOR}_velocity_limits_violation",
    f"{END_EFFECTOR}_joint_velocity_discontinuity",
    f"{END_EFFECTOR}_joint_acceleration_discontinuity",
    f"{END_EFFECTOR}_joint_velocity_limits_violation",
)
LIMITS = (f"{JOINT}_velocity_limits_violation", "joint_velocity_violation")
LOST = "communication_constraints_violation"
JUMP = joint_positions(along(6, step(0.005)))
FOLDED = (0.0, 0.0, 0.0, -2.95 - START[3], 0.0, 0.8 - START[5], 0.0)
"""Distance from the start to a pose in which the hand would touch a link [rad]."""
TOO_FAST = joint_positions(along(6, ramp(6.0, 3000.0, 6.0), factor=-1.0))
REFLEX = "reflex aborted"


def falls_silent(motion: Motion) -> Motion:
    """Return a motion that falls silent after the cycles at rest."""
    return motion.without(lambda n: n >= QUIET)


@dataclass(frozen=True)
class Cause:
    """A way to provoke an error.

    Attributes:
        motion: The motion.
        names: Errors, at least one of which must be raised.
        beside: Errors that the same cause may raise as well.
        cycles: Most cycles of the motion.
    """

    motion: Motion
    names: Sequence[str]
    beside: Sequence[str] = ()
    cycles: int = 400


CAUSES = {
    "jump of a joint position by 5 mrad": Cause(JUMP, JUMPS[:1], (*JUMPS, *LIMITS)),
    "jump of a joint velocity by 0.1 rad/s": Cause(
        joint_velocities(along(6, step(0.1))), JUMPS[:1], JUMPS
    ),
    "jump of a joint acceleration by 8 rad/s^2": Cause(
        joint_positions(along(2, ramp(8.0, inf, 0.5))), JUMPS[1:]
    ),
    "joint position 0.1 rad from the start": Cause(
        joint_positions(along(6, lambda _n: 0.1)),
        ("joint_position_motion_generator_start_pose_invalid",),
        (*JUMPS, *LIMITS),
    ),
    "joint velocity beyond the limit": Cause(TOO_FAST, LIMITS[:1], LIMITS, 1200),
    "joint position beyond the limit": Cause(
        joint_positions(along(6, ramp(4.0, 2000.0, 0.8))),
        (
            f"{JOINT}_position_limits_violation",
            "joint_position_limits_violation",
            *LIMITS[:1],
        ),
        cycles=3500,
    ),
    "jump of a pose by 5 mm": Cause(
        poses(along(2, step(0.005), 3)), SOLVED_JUMPS[:1], SOLVED_JUMPS
    ),
    "jump of a Cartesian velocity by 0.1 m/s": Cause(
        twists(along(2, step(0.1), 6)), SOLVED_JUMPS[:1], SOLVED_JUMPS
    ),
    "jump of a Cartesian acceleration by 8 m/s^2": Cause(
        poses(along(2, ramp(8.0, inf, 0.1), 3)), SOLVED_JUMPS[1:2], SOLVED_JUMPS
    ),
    "pose 5 cm from the start": Cause(
        poses(along(2, lambda _n: 0.05, 3)),
        ("cartesian_position_motion_generator_start_pose_invalid",),
        SOLVED_JUMPS,
    ),
    "rotation faster than 2.5 rad/s": Cause(
        poses(angle=ramp(8.0, 2500.0, 3.0)),
        (f"{END_EFFECTOR}_velocity_limits_violation",),
        (f"{END_EFFECTOR}_joint_velocity_limits_violation",),
        700,
    ),
    "elbow 0.3 rad from the start": Cause(
        poses(elbow=(0.3, 1.0)),
        (f"{END_EFFECTOR}_start_elbow_invalid",),
        (f"{END_EFFECTOR}_elbow_limit_violation", *SOLVED_JUMPS),
    ),
    "elbow with the other sign": Cause(
        poses(elbow=(0.0, -1.0)),
        (
            f"{END_EFFECTOR}_elbow_sign_inconsistent",
            "start_elbow_sign_inconsistent",
            f"{END_EFFECTOR}_start_elbow_invalid",
        ),
    ),
    "jump of a torque by 5 Nm": Cause(
        torques(along(6, step(5.0))), ("controller_torque_discontinuity",)
    ),
    "silence of positions at rest": Cause(falls_silent(HOLD), (LOST,)),
    "silence of torques": Cause(falls_silent(torques(rest)), (LOST,)),
    "hand against the arm itself": Cause(
        glide(FOLDED, 2500), ("self_collision_avoidance_violation",), cycles=2600
    ),
}


@pytest.mark.parametrize("cause", CAUSES.values(), ids=CAUSES)
def test_error_by_its_cause(row: Row, dialog: Dialog, cause: Cause) -> Verdict:
    row.expected = f"reflex aborted ({' or '.join(cause.names)}); recovers at once"
    outcome = dialog.move(cause.motion, cause.cycles)
    if outcome.ended != REFLEX:
        return False, outcome
    row.seen = str(outcome)
    mode = dialog.settle()["robot_mode"]
    recovered, names = dialog.recover(), {*outcome.errors}
    row.seen = f"{outcome}; robot mode {mode}; recovery: {recovered}"
    allowed = {*cause.names, *cause.beside}
    is_named = names <= allowed and not names.isdisjoint(cause.names)
    if holds := is_named and mode == RobotMode.REFLEX.value and recovered == "idle":
        dialog.go_to()
    return holds, row.seen


def test_silence_is_noticed_within_100_ms(dialog: Dialog) -> Verdict:
    """The motion ends 15 to 100 cycles after the last command."""
    outcome = dialog.move(falls_silent(HOLD), 400)
    begin = outcome.first.get("message_id", 0) + QUIET
    cycles = outcome.last.get("message_id", 0) - begin
    seen = f"{outcome}, {cycles} cycles after the last command"
    return outcome.ended == REFLEX and 15 <= cycles <= 100, seen


def test_motion_in_reflex_is_refused(dialog: Dialog) -> Verdict:
    """Move in reflex is answered with command not possible rejected."""
    outcome, answer = dialog.move(JUMP, 200), dialog.start(HOLD).words
    return answer == "command not possible rejected", f"{outcome}, then {answer}"


def test_command_that_is_not_finite_ends_the_motion(dialog: Dialog) -> Verdict:
    """The motion ends without success, and the arm does not move."""
    begin = dialog.state["q"]
    outcome = dialog.move(joint_positions(along(6, step(nan))), 200)
    moved = farthest(dialog.settle()["q"], begin)
    is_ended = outcome.ended is not None and not outcome.is_success
    return is_ended and moved < 0.01, f"{outcome}; moved by {moved:.2g} rad"


def test_load_that_is_not_there_ends_in_a_reflex(row: Row, dialog: Dialog) -> Verdict:
    """A load of 2.5 kg that is set but absent causes joint_ or cartesian_reflex."""
    inertia = (0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01)
    dialog.ask(Command.SET_LOAD, m_load=2.5, I_load=inertia)
    try:
        outcome = dialog.move(HOLD, 500)
        row.seen = str(outcome)
        dialog.recover()
    finally:
        # A load that stayed would end every later motion, also of other clients.
        dialog.ask(Command.STOP_MOVE)
        dialog.ask(Command.SET_LOAD)
    return not {"joint_reflex", "cartesian_reflex"}.isdisjoint(outcome.errors), outcome


def test_cartesian_motion_at_a_singular_pose_is_refused(
    row: Row, dialog: Dialog
) -> Verdict:
    """Move is answered with start at singular pose rejected."""
    dialog.go_to((0.0, 0.0, 0.0, -2.3, 0.0, 3.3, START[6]))
    outcome = dialog.move(poses(), 50)
    row.seen = str(outcome)
    dialog.go_to()
    return outcome.started == "start at singular pose rejected", outcome
