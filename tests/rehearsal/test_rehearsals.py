"""A rehearsal tells how a motion ends, and the live motion ends so, bit for bit."""

import pytest

import station
from station.core.clock import ManualClock
from station.core.control.controller import ControllerState
from station.core.errors import (
    RehearsalError,
)
from station.core.franka.arms import Arms
from station.core.ports.goal import GoalStatus
from station.rehearsal.planning import Wish
from station.rehearsal.rehearsals import (
    BURST,
    INTERVAL,
    Rehearsals,
    TooManyRehearsalsError,
)
from station.rehearsal.run_ahead import digest_of
from tests.two_joint_station import make_station

READY = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785]
JOINTS = [f"panda_joint{i}" for i in range(1, 8)]
POSITION = "position_joint_trajectory_controller"
EFFORT = "effort_joint_trajectory_controller"
WALL = {
    "name": "wall",
    "type": "box",
    "size": [0.2, 1.0, 1.2],
    "position": [0.65, 0.0, 0.6],
}


def moved(**offsets: float) -> list[float]:
    """Return the ready pose with some joints moved, `j1=0.3`."""
    return [q + offsets.get(f"j{i}", 0.0) for i, q in enumerate(READY, 1)]


def goal(controller, positions, seconds, **extra):
    points = [{"positions": positions, "time_from_start": seconds}]
    trajectory = {"joint_names": JOINTS, "points": points}
    request = {"trajectory": trajectory, **extra}
    return [{"kind": "goal", "name": controller, "request": request, "at": 0.0}]


def set_point(controller, values):
    command = {"values": values, "timeout": None, "rates": None, "at": 0.0}
    return [{"kind": "set_point", "name": controller, **command}]


def tight(joint, position):
    return {"path_tolerance": [{"name": joint, "position": position}]}


EFFORTS = "effort_group_effort_controller"
PIDS = "effort_group_position_controller"
# Controller, steps, kind of the error (None: none), its place (None: not looked at).
MOTIONS = {
    "calm": (POSITION, goal(POSITION, moved(j1=0.3), 1.0), None, None),
    "all joints": (POSITION, goal(POSITION, [q + 0.1 for q in READY], 1.0), None, None),
    "back": (POSITION, goal(POSITION, moved(j4=-0.3, j6=0.2), 0.8), None, None),
    "by torques": (EFFORT, goal(EFFORT, moved(j1=0.2, j7=0.3), 1.0), None, None),
    "hold by torques": (EFFORT, goal(EFFORT, READY, 0.5), None, None),
    "set-point": (PIDS, set_point(PIDS, moved(j7=0.05)), None, None),
    "stream": (
        "position_streaming_controller",
        set_point("position_streaming_controller", moved(j1=0.4)),
        None,
        None,
    ),
    "small torque": (EFFORTS, set_point(EFFORTS, [0.0] * 6 + [0.2]), None, None),
    "long way": (POSITION, goal(POSITION, moved(j1=-1.0), 2.0), None, None),
    "gains": (
        EFFORT,
        [
            {
                "kind": "gains",
                "changes": {EFFORT: {"panda_joint1/p": 500.0}},
                "at": 0.0,
            },
            *goal(EFFORT, moved(j1=0.1), 0.5),
        ],
        None,
        None,
    ),
    "into the wall": (
        POSITION,
        goal(POSITION, moved(j2=0.9, j4=0.9), 1.5),
        "reflex",
        None,
    ),
    "into the wall by torques": (
        EFFORT,
        goal(EFFORT, moved(j2=0.9, j4=0.9), 1.5),
        "reflex",
        None,
    ),
    "path tolerance of joint 1": (
        EFFORT,
        goal(EFFORT, moved(j1=0.5), 0.8, **tight("panda_joint1", 0.001)),
        "tolerance",
        "panda_joint1",
    ),
    "path tolerance of joint 4": (
        EFFORT,
        goal(EFFORT, moved(j4=0.3), 0.6, **tight("panda_joint4", 0.0008)),
        "tolerance",
        "panda_joint4",
    ),
    "goal tolerance": (
        EFFORT,
        goal(
            EFFORT,
            moved(j1=0.3),
            0.5,
            goal_tolerance=[{"name": "panda_joint1", "position": 1e-6}],
            goal_time_tolerance=0.05,
        ),
        "tolerance",
        "panda_joint1",
    ),
    "out of range": (POSITION, goal(POSITION, moved(j1=4.0), 2.0), "refused", None),
    "too few values": (PIDS, set_point(PIDS, [0.1, 0.2]), "refused", None),
    "not running": (POSITION, goal(EFFORT, READY, 1.0), "refused", None),
    "torque that throws": (
        EFFORTS,
        set_point(EFFORTS, [0.0, 0.0, 0.0, 40.0, 0.0, 0.0, 0.0]),
        "limit",
        None,
    ),
    "torque at the wrist": (
        EFFORTS,
        set_point(EFFORTS, [0.0] * 6 + [8.0]),
        "limit",
        None,
    ),
}


def begin(robot, controller):
    """Return the robot in its ready pose, with a controller that runs."""
    running = [
        one.name
        for one in robot.facade.controllers()
        if one.state is ControllerState.RUNNING
    ]
    robot.facade.release_stop(arm=False)
    robot.facade.release_stop(arm=True)
    robot.switch(stop=running)
    robot.facade.robots.recover_all()
    robot.reset()
    robot.set_gains(EFFORT, {"panda_joint1/p": 600.0})
    robot.run(0.05)
    robot.switch(start=[controller])
    robot.run(0.05)
    return robot


def live_end(robot, steps, cycles):
    """Give the last command live; return digest, first bad cycle and arm's errors."""
    facade, begin, bad = robot.facade, robot.facade.loop.cycle, None
    goals = []
    for step in steps:
        if step["kind"] == "goal":
            goals.append(facade.motion.submit_goal(step["name"], step["request"]))
        elif step["kind"] == "gains":
            facade.tuning.set_many(step["changes"])
        else:
            facade.motion.set_command(step["name"], step["values"])
    mode = robot.latest().mode
    for _ in range(cycles):
        robot.step()
        is_aborted = any(one.status is GoalStatus.ABORTED for one in goals)
        if bad is None and (robot.latest().mode != mode or is_aborted):
            bad = facade.loop.cycle
    rows = facade.snapshots.rows_since(begin)
    errors = Arms(facade.robots).report("panda").errors
    return digest_of(rows.states_of_joints()), bad, [error.name for error in errors]


@pytest.mark.parametrize("motion", MOTIONS)
def test_live_motion_ends_as_it_was_rehearsed(ready, motion):
    controller, steps, cause, where = MOTIONS[motion]
    robot = ready(controller)
    told = Rehearsals(robot.facade).rehearse(steps, None if cause else 2.2)
    error = told.error
    assert (None if error is None else error.cause) == cause, error
    if cause == "refused":
        with pytest.raises(station.core.errors.StationError) as refused:
            live_end(robot, steps, 0)
        assert error.code == refused.value.code
        return
    digest, bad, errors = live_end(robot, steps, told.cycles)
    assert (digest, bad) == (told.digest, None if error is None else error.cycle)
    if cause in {"reflex", "limit"}:
        assert error.code in errors
    if where is not None:
        assert error.where == where


STEPS = goal(EFFORT, moved(j1=0.6), 1.0)


def test_contact_names_bodies_force_and_link(ready):
    controller, steps, _, _ = MOTIONS["into the wall"]
    told = Rehearsals(ready(controller).facade).rehearse(steps)
    (touched,) = [one for one in told.contacts if "wall" in one.bodies]
    assert touched.cycle <= told.error.cycle
    assert touched.force > 10.0
    assert any("wall" in pair for pair in told.error.touching)
    (near,) = told.clearances
    assert "wall" in near.bodies
    # Looked at every 20 cycles: between two looks the arm moves some millimetres.
    assert near.distance < 0.03
    assert near.margin is None


def test_end_by_the_guard_is_a_reflex_of_the_arm(ready):
    robot = ready(EFFORTS)
    place = {"type": "sphere", "size": [0.1], "position": [0.42, 0.0, 0.15]}
    robot.facade.surroundings.put("ball", {**place, "role": "keep_out"})
    push = set_point(EFFORTS, [0.0, 20.0, 0.0, -15.0, 0.0, 0.0, 0.0])
    told = Rehearsals(robot.facade).rehearse(push, 1.0)
    robot.facade.surroundings.remove("ball")
    error = told.error
    found = (error.cause.value, error.where, error.code)
    assert found == ("reflex", "panda", "guard_reflex")
    assert "'ball'" in error.text


def test_least_clearances_are_those_of_the_motion_that_follows(ready):
    robot = ready(EFFORT)
    place = {"type": "sphere", "size": [0.05], "position": [0.4, 0.4, 0.6]}
    robot.facade.surroundings.put("ball", {**place, "role": "keep_out"})
    told = Rehearsals(robot.facade).rehearse(STEPS)
    solid, kept = told.clearances
    assert solid.bodies[1] in {"wall", "world"}
    assert solid.distance > 0.1
    robot.facade.motion.submit_goal(EFFORT, STEPS[0]["request"])
    pairs = []
    for _ in range(told.cycles):
        robot.step()
        pairs.append(robot.facade.surroundings.clearance("panda"))
    robot.facade.surroundings.remove("ball")
    least = min(pairs, key=lambda pair: pair.distance)
    assert (kept.bodies, kept.distance) == ((least.link, "ball"), least.distance)
    assert kept.cycle == told.begin_cycle + pairs.index(least)
    assert kept.margin == 0.02


def test_rehearsal_changes_nothing(ready):
    facade = ready(EFFORT).facade
    before = facade.loop.cycle, facade.latest().position
    Rehearsals(facade).rehearse(MOTIONS["gains"][1])
    assert (facade.loop.cycle, facade.latest().position) == before
    assert facade.tuning.gains(EFFORT).values["panda_joint1/p"] != 500.0


def test_script_carries_its_steps_out_at_their_times(ready):
    rehearsals = Rehearsals(ready(POSITION).facade)
    later = [{**STEPS[0], "name": POSITION, "at": 0.5}]
    told = rehearsals.rehearse(later, 1.0, certify=True)
    rows = zip(told.times, told.positions, strict=True)
    here = [row[0] for time, row in rows if time < 0.5]
    assert max(here) - min(here) < 1e-3 < told.positions[-1][0] - here[0]
    assert (told.outcome, told.certificate) == ("unfinished", None)


def test_each_client_gets_copies_of_a_live_station_at_a_bounded_rate(monkeypatch):
    def refuse(*_):
        raise RehearsalError("It is not copied here.")

    def ask(who):
        with pytest.raises(RehearsalError, match="not copied"):
            rehearsals.rehearse([], who=who)

    monkeypatch.setattr("station.rehearsal.rehearsals.run_in_copy", refuse)
    clock, own = ManualClock(), make_station()
    rehearsals = Rehearsals(own, now=clock.now)
    for _ in range(BURST + 1):
        ask("ada")  # nothing runs that a copy could delay
    own.loop.start()
    try:
        for _ in range(BURST):
            ask("ada")
            ask(None)
        clock.advance(0.25 * INTERVAL)
        with pytest.raises(TooManyRehearsalsError, match="ada") as refused:
            rehearsals.rehearse([], who="ada")
        assert refused.value.details == {"retry_after": 0.75 * INTERVAL}
        ask("bob")
        ask(None)
        clock.advance(0.75 * INTERVAL)
        ask("ada")
        with pytest.raises(TooManyRehearsalsError):
            rehearsals.plan(Wish("arm", {}), "ada")
    finally:
        own.loop.stop()
