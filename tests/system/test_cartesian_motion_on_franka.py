"""Streaming poses to the simulated arm and jogging its end effector."""

import math
from itertools import pairwise
from random import Random

import pytest

from station.core.control.switching import SwitchRequest
from station.core.facade.station import Station
from station.core.franka.arms import Arms
from tests.franka_station import JOINTS, make_franka_station

PARAMETERS = {"arm_id": "panda", "joint_names": JOINTS}
UNLIMITED = {"rate_limiting": False, "cutoff_frequency": 1000.0}
EVERY = 20
"""Cycles between two set-points: 50 Hz."""


def start(kind: str, **robot: object) -> Station:
    """Return a station whose Cartesian controller `arm` has just been started."""
    station = make_franka_station(**robot)
    station.load_controller(
        "cartesian", f"franka_controllers/Cartesian{kind}Controller", PARAMETERS
    )
    station.switch_controllers(SwitchRequest(("cartesian",), ()))
    step(station, 5)
    return station


def step(station: Station, cycles: int) -> None:
    for _ in range(cycles):
        station.loop.clock.advance(0.001)
        station.loop.step()


def position(station: Station) -> list[float]:
    """Return where the end effector is measured [m]."""
    return list(Arms(station.robots).state("panda").O_T_EE[12:15])


def check_content(station: Station) -> None:
    assert station.controller("cartesian").fault is None
    assert station.latest().mode == "move"
    assert not any(Arms(station.robots).state("panda").last_motion_errors)


@pytest.mark.slow
@pytest.mark.parametrize("robot", [{}, UNLIMITED], ids=["limiter", "no limiter"])
def test_a_square_streamed_at_fifty_hertz_is_driven(robot) -> None:
    station = start("Streaming", **robot)
    pose = list(station.controller_sample("cartesian").desired)
    begin = position(station)
    corners = []
    for axis, side in ((1, 0.1), (2, 0.1), (1, -0.1), (2, -0.1)):
        for _ in range(50):
            pose[axis] += side / 50.0
            station.motion.set_command("cartesian", pose)
            step(station, EVERY)
        for _ in range(50):
            station.motion.set_command("cartesian", pose)
            step(station, EVERY)
        corners.append(math.dist(position(station), pose[:3]))
    check_content(station)
    assert max(corners) < 0.001
    assert position(station) == pytest.approx(begin, abs=0.001)


@pytest.mark.long
@pytest.mark.parametrize("robot", [{}, UNLIMITED], ids=["limiter", "no limiter"])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("axis", range(6))
def test_a_jog_button_held_to_the_end_of_the_workspace_is_no_error(
    robot, axis, sign
) -> None:
    station = start("Jog", **robot)
    twist = [0.0] * 6
    twist[axis] = sign * (0.3 if axis < 3 else 1.0)
    for _ in range(250):
        station.motion.set_command("cartesian", twist)
        step(station, EVERY)

    check_content(station)
    assert station.published("cartesian")["state"]["obstacle"] != "none"


def test_a_stop_ends_a_jog_and_nothing_resumes() -> None:
    station = start("Jog")
    for _ in range(10):
        station.motion.set_command("cartesian", [0.0, 0.1, 0.0, 0.0, 0.0, 0.0])
        step(station, EVERY)
    station.stop("test")
    step(station, 500)
    held = position(station)
    step(station, 200)

    assert station.controller("cartesian").state.value == "stopped"
    assert position(station) == pytest.approx(held, abs=1e-4)


def test_starting_moves_nothing_and_silence_ends_a_motion() -> None:
    station = start("Streaming", **UNLIMITED)
    begin = position(station)
    step(station, 100)
    assert position(station) == pytest.approx(begin, abs=5e-4)
    pose = list(station.controller_sample("cartesian").desired)
    pose[1] += 0.2
    station.motion.set_command("cartesian", pose)
    track = []
    for _ in range(40):
        step(station, EVERY)
        track.append(position(station)[1])

    check_content(station)
    assert track[-1] - begin[1] < 0.1
    assert abs(track[-1] - track[-5]) < 5e-4
    assert max(b - a for a, b in pairwise(track)) < 0.3 * EVERY * 1e-3


@pytest.mark.parametrize("robot", [{}, UNLIMITED], ids=["limiter", "no limiter"])
def test_late_cycles_are_no_error(robot) -> None:
    station, random = start("Streaming", **robot), Random(3)
    pose = list(station.controller_sample("cartesian").desired)
    for number in range(150):
        pose[1] += 0.002 * math.cos(number / 20.0)
        station.motion.set_command("cartesian", pose)
        step(station, 8)
        # The loop is late by some cycles: the arm has gone on by itself.
        station.loop.period = 1e-3 * random.randrange(2, 9)
        step(station, 1)
        station.loop.period = 1e-3

    check_content(station)


def stall(station: Station, random: Random) -> None:
    """Let some cycles in a row be late, by 1 to 300 ms each."""
    for _ in range(random.randrange(1, 5)):
        late = random.randrange(1, random.choice([2, 4, 11, 31, 101, 301]))
        station.loop.delay_next_cycle(late)
        step(station, 1)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("robot", [{}, UNLIMITED], ids=["limiter", "no limiter"])
def test_stalls_in_a_streamed_square_are_no_error(robot, seed) -> None:
    station = start("Streaming", realtime_config="ignore", **robot)
    random = Random(seed)
    pose = list(station.controller_sample("cartesian").desired)
    for axis, side in ((1, 0.1), (2, 0.1), (1, -0.1), (2, -0.1)):
        for _ in range(50):
            pose[axis] += side / 50.0
            station.motion.set_command("cartesian", pose)
            step(station, random.randrange(1, EVERY))
            if random.random() < 0.3:
                stall(station, random)
    for _ in range(50):
        station.motion.set_command("cartesian", pose)
        step(station, EVERY)

    check_content(station)
    assert math.dist(position(station), pose[:3]) < 0.001


@pytest.mark.long
@pytest.mark.parametrize("axis", range(6))
def test_stalls_while_a_jog_button_is_held_are_no_error(axis) -> None:
    robot, random = UNLIMITED if axis % 2 else {}, Random(axis)
    station = start("Jog", realtime_config="ignore", **robot)
    twist = [0.0] * 6
    for number in range(300):
        if number % 100 == 0:  # to the end of the workspace, and back
            twist[axis] = (0.3 if axis < 3 else 1.0) * (-1.0) ** (number // 100)
        station.motion.set_command("cartesian", twist)
        step(station, random.randrange(1, EVERY))
        if random.random() < 0.3:
            stall(station, random)

    check_content(station)
