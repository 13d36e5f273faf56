"""Checks that provoke errors: each by its cause, by its name, and recovered at once.

An error may have others beside it that the same cause raises; any other one is a
failure. Source: Franka Control Interface documentation, Errors, and Robot and interface
specifications; libfranka@0.15.0 include/franka/errors.h.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import nan

import pytest

from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.fci.wire.robot_protocol import (
    Command,
    MoveController,
    MoveGenerator,
    MoveStatus,
)
from station.testing.fci_conformance.dialog import (
    Dialog,
    Fields,
    State,
    Stream,
    words,
)
from station.testing.fci_conformance.moving import (
    CARTESIAN,
    EXTERNAL,
    JOINTS,
    POSE,
    POSITION,
    START,
    TWIST,
    VELOCITY,
    go_to,
    recover,
    torque_generator,
)
from station.testing.fci_conformance.plugin import Row
from station.testing.fci_conformance.trajectories import (
    Ramp,
    along,
    joint_positions,
    joint_velocities,
    one_joint,
    poses,
    smooth,
    torques,
    twists,
)

pytestmark = pytest.mark.moves

QUIET = 50
"""Cycles at rest before the cause."""
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


def turned(joint: int, angle: float) -> list[float]:
    """Return the start pose with another angle of one joint [rad]."""
    return [angle if i == joint else q for i, q in enumerate(START)]


def after_rest(ramp: Ramp) -> Callable[[int], Ramp]:
    """Return a function that lets a ramp begin after the cycles at rest."""
    return lambda cycle: ramp.advance(cycle - QUIET)


def falls_silent(stream: Stream) -> Stream:
    """Return a stream that ends after the cycles at rest, without a finish."""
    return lambda cycle, state: stream(cycle, state) if cycle < QUIET else None


def with_elbow(away: float, sign: float) -> Callable[[], Stream]:
    """Return a maker of streams that command an elbow besides the pose."""

    def make() -> Stream:
        stream = poses(lambda _n: [0.0] * 3)

        def stream_with_elbow(cycle: int, state: State) -> Fields | None:
            first = state["elbow_d"]
            elbow = first[0] + away, first[1] * sign
            return {
                **(stream(cycle, state) or {}),
                "elbow_c": elbow,
                "valid_elbow": True,
            }

        return stream_with_elbow

    return make


@dataclass(frozen=True)
class Cause:
    """A way to provoke an error.

    Attributes:
        controller: The controller of the motion.
        generator: Its motion generator; None: that of torques alone.
        stream: Makes the commands.
        names: The errors of which at least one has to be raised.
        beside: Errors that the same cause may raise as well.
        pose: The joints at the beginning [rad].
        cycles: How long the motion lasts at most.
    """

    controller: MoveController
    generator: MoveGenerator | None
    stream: Callable[[], Stream]
    names: Sequence[str]
    beside: Sequence[str] = ()
    pose: Sequence[float] = START
    cycles: int = 400


def ramp_positions(joint: int, *bounds: float) -> Callable[[], Stream]:
    """Return a maker of positions of a joint that follow a `Ramp`."""

    def make() -> Stream:
        ramp = after_rest(Ramp(*bounds))
        return joint_positions(lambda n: one_joint(joint, ramp(n).way))

    return make


def ramp_height(*bounds: float) -> Callable[[], Stream]:
    """Return a maker of poses that go up by a `Ramp`."""

    def make() -> Stream:
        ramp = after_rest(Ramp(*bounds))
        return poses(lambda n: along(2, ramp(n).way))

    return make


def ramp_turn(*bounds: float) -> Callable[[], Stream]:
    """Return a maker of poses that turn about the z axis by a `Ramp`."""

    def make() -> Stream:
        ramp = after_rest(Ramp(*bounds))
        return poses(lambda _n: [0.0] * 3, lambda n: ramp(n).way)

    return make


def step(first: int, value: float) -> Callable[[int], float]:
    """Return a function that is 0 before a cycle, and a value from then on."""
    return lambda n: value if n >= first else 0.0


def fold() -> Stream:
    """Return positions that fold the arm until the hand comes near a link."""
    way = [0.0, 0.0, 0.0, -2.95 - START[3], 0.0, 0.8 - START[5], 0.0]
    return joint_positions(lambda n: [smooth(n / 2500) * one for one in way])


CAUSES = {
    "jump of a joint position by 5 mrad": Cause(
        JOINTS,
        POSITION,
        lambda: joint_positions(lambda n: one_joint(6, step(QUIET, 0.005)(n))),
        JUMPS[:1],
        (*JUMPS, *LIMITS),
    ),
    "jump of a joint velocity by 0.1 rad/s": Cause(
        JOINTS,
        VELOCITY,
        lambda: joint_velocities(lambda n: one_joint(6, step(QUIET, 0.1)(n))),
        JUMPS[:1],
        JUMPS,
    ),
    "jump of a joint acceleration by 8 rad/s^2": Cause(
        JOINTS, POSITION, ramp_positions(2, 8.0, 0.0, 0.5), JUMPS[1:]
    ),
    "joint position 0.1 rad from the start": Cause(
        JOINTS,
        POSITION,
        lambda: joint_positions(lambda _n: one_joint(6, 0.1)),
        ("joint_position_motion_generator_start_pose_invalid",),
        (*JUMPS, *LIMITS),
    ),
    "joint velocity beyond the limit": Cause(
        JOINTS,
        POSITION,
        ramp_positions(6, 6.0, 3000.0, 6.0),
        LIMITS[:1],
        LIMITS,
        turned(6, -2.6),
        1200,
    ),
    "joint position beyond the limit": Cause(
        JOINTS,
        POSITION,
        ramp_positions(6, 4.0, 2000.0, 0.8),
        (
            f"{JOINT}_position_limits_violation",
            "joint_position_limits_violation",
            *LIMITS[:1],
        ),
        (),
        turned(6, 2.5),
        1500,
    ),
    "jump of a pose by 5 mm": Cause(
        CARTESIAN,
        POSE,
        lambda: poses(lambda n: along(2, step(QUIET, 0.005)(n))),
        SOLVED_JUMPS[:1],
        SOLVED_JUMPS,
    ),
    "jump of a Cartesian velocity by 0.1 m/s": Cause(
        CARTESIAN,
        TWIST,
        lambda: twists(lambda n: along(2, step(QUIET, 0.1)(n), 6)),
        SOLVED_JUMPS[:1],
        SOLVED_JUMPS,
    ),
    "jump of a Cartesian acceleration by 8 m/s^2": Cause(
        CARTESIAN, POSE, ramp_height(8.0, 0.0, 0.1), SOLVED_JUMPS[1:2], SOLVED_JUMPS
    ),
    "pose 5 cm from the start": Cause(
        CARTESIAN,
        POSE,
        lambda: poses(lambda _n: along(2, 0.05)),
        ("cartesian_position_motion_generator_start_pose_invalid",),
        SOLVED_JUMPS,
    ),
    "rotation faster than 2.5 rad/s": Cause(
        CARTESIAN,
        POSE,
        ramp_turn(8.0, 2500.0, 3.0),
        (f"{END_EFFECTOR}_velocity_limits_violation",),
        (f"{END_EFFECTOR}_joint_velocity_limits_violation",),
        cycles=700,
    ),
    "elbow 0.3 rad from the start": Cause(
        CARTESIAN,
        POSE,
        with_elbow(0.3, 1.0),
        (f"{END_EFFECTOR}_start_elbow_invalid",),
        (f"{END_EFFECTOR}_elbow_limit_violation", *SOLVED_JUMPS),
    ),
    "elbow with the other sign": Cause(
        CARTESIAN,
        POSE,
        with_elbow(0.0, -1.0),
        (
            f"{END_EFFECTOR}_elbow_sign_inconsistent",
            "start_elbow_sign_inconsistent",
            f"{END_EFFECTOR}_start_elbow_invalid",
        ),
    ),
    "jump of a torque by 5 Nm": Cause(
        EXTERNAL,
        None,
        lambda: torques(step(QUIET, 5.0)),
        ("controller_torque_discontinuity",),
    ),
    "silence of positions at rest": Cause(
        JOINTS,
        POSITION,
        lambda: falls_silent(joint_positions(lambda _n: [0.0] * 7)),
        (LOST,),
    ),
    "silence of torques": Cause(
        EXTERNAL, None, lambda: falls_silent(torques(lambda _n: 0.0)), (LOST,)
    ),
    "hand against the arm itself": Cause(
        JOINTS, POSITION, fold, ("self_collision_avoidance_violation",), cycles=2600
    ),
}


@pytest.mark.parametrize("cause", CAUSES)
def test_error_by_its_cause(row: Row, dialog: Dialog, cause: str) -> None:
    one = CAUSES[cause]
    row.expect(f"reflex aborted ({' or '.join(one.names)}); recovers at once")
    go_to(dialog, one.pose)
    generator = one.generator
    if generator is None:
        generator = torque_generator(dialog)
    outcome = dialog.move(one.controller, generator, one.stream(), one.cycles)
    row.see(outcome)
    if outcome.ended is None or outcome.ended == MoveStatus.SUCCESS:
        go_to(dialog)
    assert outcome.ended == MoveStatus.REFLEX_ABORTED
    mode = dialog.settle()["robot_mode"]
    recovered = recover(dialog)
    row.see(f"{outcome}; robot mode {mode}; recovery: {recovered}")
    assert set(outcome.errors) & set(one.names)
    assert set(outcome.errors) <= {*one.names, *one.beside}
    assert mode == RobotMode.REFLEX.value
    assert recovered == "idle"
    go_to(dialog)


def test_silence_is_noticed_within_100_ms(row: Row, dialog: Dialog) -> None:
    row.expect("the end of the motion 20 to 100 cycles after the last command")
    go_to(dialog)
    stream = falls_silent(joint_positions(lambda _n: [0.0] * 7))
    outcome = dialog.move(JOINTS, POSITION, stream, 400)
    begin = outcome.first.get("message_id", 0) + QUIET
    cycles = outcome.last.get("message_id", 0) - begin
    row.see(f"{outcome}, {cycles} cycles after the last command")
    recover(dialog)
    assert outcome.ended == MoveStatus.REFLEX_ABORTED
    assert 15 <= cycles <= 100


def test_motion_in_reflex_is_refused(row: Row, dialog: Dialog) -> None:
    row.expect("Move in reflex: command not possible rejected")
    go_to(dialog)
    stream = joint_positions(lambda n: one_joint(6, step(QUIET, 0.005)(n)))
    outcome = dialog.move(JOINTS, POSITION, stream, 200)
    _, answer = dialog.start(JOINTS, POSITION)
    row.see(f"{outcome}, then {words(MoveStatus, answer.status)}")
    recover(dialog)
    assert answer.status == MoveStatus.COMMAND_NOT_POSSIBLE_REJECTED


def test_command_that_is_not_finite_ends_the_motion(row: Row, dialog: Dialog) -> None:
    row.expect("an end that is no success, and no motion of the arm")
    go_to(dialog)
    begin = dialog.state["q"]
    stream = joint_positions(lambda n: one_joint(6, step(QUIET, nan)(n)))
    outcome = dialog.move(JOINTS, POSITION, stream, 200)
    after = dialog.settle()
    moved = max(abs(a - b) for a, b in zip(after["q"], begin, strict=True))
    row.see(f"{outcome}; moved by {moved:.2g} rad")
    recover(dialog)
    assert outcome.ended not in (MoveStatus.SUCCESS, None)
    assert moved < 0.01


def test_load_that_is_not_there_ends_in_a_reflex(row: Row, dialog: Dialog) -> None:
    row.expect("joint_reflex or cartesian_reflex by a load of 2.5 kg that is not there")
    go_to(dialog)
    inertia = (0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01)
    dialog.ask(Command.SET_LOAD, m_load=2.5, I_load=inertia)
    stream = joint_positions(lambda _n: [0.0] * 7)
    outcome = dialog.move(JOINTS, POSITION, stream, 500)
    errors = set(outcome.errors)
    row.see(outcome)
    recover(dialog)
    dialog.ask(Command.SET_LOAD)
    recover(dialog)
    assert errors & {"joint_reflex", "cartesian_reflex"}


def test_cartesian_motion_at_a_singular_pose_is_refused(
    row: Row, dialog: Dialog
) -> None:
    row.expect("Move answered with start at singular pose rejected")
    go_to(dialog, (0.0, 0.0, 0.0, -2.3, 0.0, 3.3, START[6]))
    stream = poses(lambda _n: [0.0] * 3)
    outcome = dialog.move(CARTESIAN, POSE, stream, 50)
    row.see(outcome)
    go_to(dialog)
    assert outcome.started == MoveStatus.START_AT_SINGULAR_POSE_REJECTED
