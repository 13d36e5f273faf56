"""Motions near a pose, motions to it, and commands that an arm must refuse.

A stream is called once per cycle with the cycle's number, see `dialog.Stream`. Cycles
are 1 ms, and a stream leaves nothing out when the client misses a state.
"""

from collections.abc import Callable, Iterable, Sequence
from math import cos, inf, pi, sin, sqrt
from typing import TypeAlias

from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.fci.wire.robot_protocol import (
    Command,
    MoveController,
    MoveGenerator,
    RecoveryStatus,
)
from station.testing.fci_conformance.dialog import (
    LONGEST_END,
    Dialog,
    FciSilenceError,
    Fields,
    Motion,
    Outcome,
    State,
    words,
)

JOINTS = MoveController.JOINT_IMPEDANCE
CARTESIAN = MoveController.CARTESIAN_IMPEDANCE
CYCLE = 0.001
"""Time from one state to the next [s]."""
START = (0.0, -pi / 4, 0.0, -3 * pi / 4, 0.0, pi / 2, pi / 4)
"""The pose at which the checks begin [rad]; libfranka's examples begin there."""
_SPEED = (1.0, 1.0, 1.0, 1.0, 1.6, 1.6, 1.6)  # [rad/s]
_ACCELERATION = 5.0  # [rad/s^2]
_SHORTEST = 0.2  # [s]
_THERE = 0.02
_STILL = 1e-3  # [rad/s]
QUIET = 50
"""Cycles at rest before `step` and `ramp`."""
Way: TypeAlias = Callable[[int], float]
"""Function that returns a number for a cycle, e.g. a distance from the start."""
Ways: TypeAlias = Callable[[int], Sequence[float]]
"""Function that returns a vector for a cycle."""


def smooth(part: float) -> float:
    """Return the share of a rest-to-rest motion with bounded jerk that is done.

    Args:
        part: Share of its time that has passed, 0 to 1.
    """
    part = min(max(part, 0.0), 1.0)
    return part**3 * (10.0 - 15.0 * part + 6.0 * part**2)


def there_and_back(part: float) -> float:
    """Return a motion to 1 and back to 0, from rest to rest; see `smooth`."""
    return smooth(2.0 * part) - smooth(2.0 * part - 1.0)


def rate(way: Way) -> Way:
    """Return the velocity of a motion from one cycle to the next, per second."""
    return lambda n: (way(n) - way(n - 1)) / CYCLE if n else 0.0


def step(value: float) -> Way:
    """Return a function that is 0 in the cycles at rest, and `value` afterwards."""
    return lambda n: value if n >= QUIET else 0.0


def ramp(acceleration: float, jerk: float, velocity: float) -> Way:
    """Return a distance that grows ever faster, after the cycles at rest.

    Args:
        acceleration: Largest acceleration, per second squared.
        jerk: Largest jerk, per second cubed; 0 lets the acceleration jump.
        velocity: Velocity at which the acceleration ends, per second.
    """
    ways, grows, speed = [0.0], 0.0, 0.0

    def way(cycle: int) -> float:
        nonlocal grows, speed
        while len(ways) <= cycle - QUIET:
            more = jerk * CYCLE if jerk else acceleration
            grows = min(acceleration, grows + more)
            speed = min(velocity, speed + grows * CYCLE)
            ways.append(ways[-1] + speed * CYCLE)
        return ways[max(0, cycle - QUIET)]

    return way


def along(axis: int, way: Way, size: int = 7) -> Ways:
    """Return a motion of one joint, or along one axis, as a vector function."""
    return lambda n: [way(n) if i == axis else 0.0 for i in range(size)]


def begin_of(field: str) -> Callable[[State], tuple[float, ...]]:
    """Return a function that returns a field of the first state it was called with."""
    kept: list[tuple[float, ...]] = []

    def first(state: State) -> tuple[float, ...]:
        if not kept:
            kept.append(tuple(state[field]))
        return kept[0]

    return first


def joint_positions(way: Ways) -> Motion:
    """Return a motion of joint positions.

    Args:
        way: Returns the distance from the first `q_d` in a cycle [rad], shape (7,).
    """
    begin = begin_of("q_d")

    def stream(cycle: int, state: State) -> Fields:
        pairs = zip(begin(state), way(cycle), strict=True)
        return {"q_c": [q + offset for q, offset in pairs]}

    return Motion(JOINTS, MoveGenerator.JOINT_POSITION, stream)


def hold() -> Motion:
    """Return a motion that stays at the first position."""
    return joint_positions(lambda _n: [0.0] * 7)


def joint_velocities(velocity: Ways) -> Motion:
    """Return a motion of joint velocities, shape (7,) [rad/s]."""
    generator = MoveGenerator.JOINT_VELOCITY
    return Motion(JOINTS, generator, lambda n, _state: {"dq_c": list(velocity(n))})


def poses(
    shift: Ways = lambda _n: (),
    angle: Way = lambda _n: 0.0,
    elbow: tuple[float, float] | None = None,
) -> Motion:
    """Return a motion of poses of the end effector.

    Args:
        shift: Returns the distance from the first pose in a cycle, in the base frame
            [m], shape (3,).
        angle: Returns the turn about the z axis of the end effector [rad].
        elbow: Distance of the elbow from its present position [rad], and factor of its
            sign; None commands no elbow.
    """
    begin, begin_elbow = begin_of("O_T_EE_c"), begin_of("elbow_d")

    def stream(cycle: int, state: State) -> Fields:
        pose = list(begin(state))
        x, y = pose[0:3], pose[4:7]
        c, s = cos(angle(cycle)), sin(angle(cycle))
        pose[0:3] = [c * a + s * b for a, b in zip(x, y, strict=True)]
        pose[4:7] = [c * b - s * a for a, b in zip(x, y, strict=True)]
        for i, way in enumerate(shift(cycle)):
            pose[12 + i] += way
        if elbow is None:
            return {"O_T_EE_c": pose}
        joint, sign = begin_elbow(state)
        commanded = joint + elbow[0], sign * elbow[1]
        return {"O_T_EE_c": pose, "elbow_c": commanded, "valid_elbow": True}

    return Motion(CARTESIAN, MoveGenerator.CARTESIAN_POSITION, stream)


def twists(twist: Ways) -> Motion:
    """Return a motion of twists of the end effector, shape (6,) [m/s, rad/s]."""
    generator = MoveGenerator.CARTESIAN_VELOCITY
    return Motion(CARTESIAN, generator, lambda n, _state: {"O_dP_EE_c": list(twist(n))})


def torques(torque: Ways = lambda _n: [0.0] * 7) -> Motion:
    """Return a motion of torques only, shape (7,) [Nm]."""
    external = MoveController.EXTERNAL_CONTROLLER
    return Motion(external, None, lambda n, _state: {"tau_J_d": list(torque(n))})


def recover(dialog: Dialog) -> str:
    """Recover once; return `idle` if the arm is idle then, else the answer in words.

    Raises:
        FciNetworkError: No answer comes.
    """
    number = dialog.client.send(Command.AUTOMATIC_ERROR_RECOVERY)
    answer = dialog.client.take_answer(number, LONGEST_END)
    if answer is None:
        return f"no answer within {LONGEST_END:g} s"
    if answer.status != RecoveryStatus.SUCCESS:
        return words(RecoveryStatus, answer.status)
    if not dialog.wait_until(lambda s: s["robot_mode"] == RobotMode.IDLE.value, 1.0):
        return f"success, and robot mode {dialog.state['robot_mode']}"
    if any(dialog.state["errors"]):
        return "success, and the errors are still there"
    return "idle"


def go_to(dialog: Dialog, q: Sequence[float] = START) -> None:
    """Move the joints slowly to a pose; recover from a reflex first if necessary.

    Raises:
        FciNetworkError: The endpoint does not answer.
        FciSilenceError: The arm does not arrive.
    """
    state = dialog.settle()
    if state["robot_mode"] != RobotMode.IDLE.value:
        recover(dialog)
    # The arm may still be slowing down from the last motion.
    dialog.wait_until(lambda s: max(map(abs, s["dq_d"])) < _STILL, 1.0)
    state = dialog.state
    way = [goal - now for goal, now in zip(q, state["q_d"], strict=True)]
    longest = max(map(abs, way))
    if longest < 1e-3:
        return
    # In `smooth` the peaks of velocity and acceleration are this much above the mean.
    slow = max(1.875 * abs(a) / v for a, v in zip(way, _SPEED, strict=True))
    seconds = max(_SHORTEST, slow, sqrt(5.7735 * longest / _ACCELERATION))
    cycles = round(1000.0 * seconds)
    motion = joint_positions(lambda n: [smooth(n / cycles) * one for one in way])
    outcome = dialog.move(motion, cycles + 20)
    # A compliant arm arrives after the end of its motion.
    is_there = outcome.is_success and dialog.wait_until(
        lambda state: farthest(state["q"], q) < _THERE, 0.5
    )
    if not is_there:
        away = inf if outcome.ended is None else distance(outcome, "q", q)
        raise FciSilenceError(
            f"on the way to the pose of the check: {outcome}, {away:.3f} rad off it"
        )


def distance(outcome: Outcome, field: str, wanted: Sequence[float]) -> float:
    """Return the largest difference of a field's last values from the wanted ones."""
    return farthest(outcome.last[field], wanted)


def farthest(one: Iterable[float], other: Iterable[float]) -> float:
    """Return the largest difference between two vectors."""
    return max(abs(a - b) for a, b in zip(one, other, strict=True))
