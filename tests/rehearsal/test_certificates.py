"""A certified motion keeps to what was rehearsed and to its bounds, or is not made."""

import numpy as np
import pytest

from station.core.errors import CertificateVoidError, RehearsalNeededError
from station.core.franka.arms import Arms
from station.core.franka.franka_services import FrankaServices
from station.core.loop.stop_latch import StopState
from station.core.ports.goal import GoalStatus
from station.rehearsal.envelope import Envelope
from station.rehearsal.process_copy import run_in_copy
from station.rehearsal.rehearsals import AgentEnvelopeError, Policy, Rehearsals, Rules
from station.rehearsal.run_ahead import Script, run_ahead
from tests.rehearsal.test_rehearsals import (
    EFFORT,
    JOINTS,
    MOTIONS,
    POSITION,
    READY,
    STEPS,
    goal,
    moved,
    set_point,
)

CHANGES = {
    "'wall' was": lambda robot: robot.facade.surroundings.put("wall", {"margin": 0.03}),
    "epoch": lambda robot: robot.reset(),
    "gain": lambda robot: robot.set_gains(EFFORT, {"panda_joint1/p": 590.0}),
    "wall": lambda robot: move_wall(robot),
    "Other controllers": lambda robot: robot.switch(stop=["joint_state_controller"]),
    "panda_joint": lambda robot: robot.facade.loop.run_in_cycle(lambda: push(robot)),
    "unload": lambda robot: robot.facade.unload_controller("position_jog_controller"),
}


def move_wall(robot):
    world = robot.facade.loop.hw.simulated_world().world
    world.model.body("wall").pos[0] += 0.01
    robot.step(2)


def push(robot):
    arms = Arms(robot.facade.robots)
    arms.apply_force("panda", "panda_link4", [0.0, 60.0, 0.0], [0.0] * 3, 0.2)
    robot.run(0.15)


@pytest.mark.parametrize("named", CHANGES)
def test_certificate_is_void_after_a_change(ready, named):
    robot = ready(EFFORT)
    if named == "Other controllers":
        robot.switch(start=["joint_state_controller"])
    rehearsals = Rehearsals(robot.facade)
    certificate = rehearsals.rehearse(STEPS, certify=True).certificate
    CHANGES[named](robot)
    with (
        pytest.raises(CertificateVoidError, match=named),
        rehearsals.redeemed(certificate.name, STEPS[0]),
    ):
        pytest.fail("the command was admitted")


def certified(robot, rehearsals):
    certificate = rehearsals.rehearse(STEPS, certify=True).certificate
    with rehearsals.redeemed(certificate.name, STEPS[0]) as ticket:
        robot.facade.motion.submit_goal(EFFORT, STEPS[0]["request"], ticket=ticket)


def test_certified_motion_is_carried_out_once(ready):
    robot = ready(EFFORT)
    rehearsals = Rehearsals(robot.facade)
    certified(robot, rehearsals)
    robot.run(1.2)
    assert robot.facade.motion.goals(EFFORT)[-1].status is GoalStatus.SUCCEEDED
    assert robot.facade.loop.stop_latch.state is StopState.ARMED


def test_push_stops_a_certified_motion_within_three_cycles(ready):
    robot = ready(EFFORT)
    certified(robot, Rehearsals(robot.facade))
    width = Rules().tolerances.tube
    rehearsed = station_copy(robot)
    robot.run(0.3)
    arms = Arms(robot.facade.robots)
    arms.apply_force("panda", "panda_link4", [0.0, 60.0, 0.0], [0.0] * 3, 0.3)
    begin, left = robot.facade.loop.cycle, None
    for _ in range(500):
        robot.step()
        k = robot.facade.loop.cycle - rehearsed[0]
        off = max(np.abs(np.array(robot.latest().position) - rehearsed[1][k - 1])[:7])
        if left is None and off > width:
            left = robot.facade.loop.cycle
        if robot.facade.loop.stop_latch.state is StopState.STOPPED and left:
            break
    robot.step()
    latch = robot.facade.loop.stop_latch
    assert begin < left < latch.cycle <= left + 3
    assert "rehearsed motion" in latch.reason


def station_copy(robot):
    """Return the present cycle and the positions that follow without a push."""
    script = Script([], 0.9)
    found = run_in_copy(lambda tell: run_ahead(robot.facade, script, {}, tell))
    return robot.facade.loop.cycle, found.positions


def test_other_command_is_no_certified_one(ready):
    robot = ready(EFFORT)
    rehearsals = Rehearsals(robot.facade)
    certificate = rehearsals.rehearse(STEPS, certify=True).certificate
    other = goal(EFFORT, moved(j1=0.7), 1.0)[0]
    with (
        pytest.raises(CertificateVoidError, match="another command"),
        rehearsals.redeemed(certificate.name, other),
    ):
        pytest.fail("the command was admitted")


VELOCITY = "velocity_group_controller"
STREAM = "position_streaming_controller"


def path_that_loops(controller):
    """Return a step that plays a path again and again."""
    step = goal(controller, moved(j1=0.1), 1.0)[0]
    return [{"kind": "path", "path": "p", "options": {"loop": True}, "at": 0.0}], {
        "path": lambda _: step
    }


@pytest.mark.parametrize(
    ("controller", "steps", "seconds"),
    [
        (VELOCITY, set_point(VELOCITY, [0.3] + [0.0] * 6), 1.0),
        (STREAM, set_point(STREAM, moved(j1=1.5)), 0.01),
        (STREAM, set_point(STREAM, moved(j1=1.5)) + set_point(STREAM, READY), None),
        (EFFORT, [MOTIONS["gains"][1][0], *goal(EFFORT, READY, 0.5)], None),
        (POSITION, path_that_loops, None),
    ],
    ids=["goes on", "too short", "replaced at once", "gains", "loops"],
)
def test_a_motion_that_the_rehearsal_does_not_bound_gets_no_certificate(
    ready, controller, steps, seconds
):
    robot, plans = ready(controller), {}
    if callable(steps):
        steps, plans = steps(controller)
    told = Rehearsals(robot.facade, plans).rehearse(steps, seconds, certify=True)
    assert (told.outcome, told.certificate) == ("completed", None)


def test_a_trajectory_that_waits_first_is_rehearsed_to_its_end(ready):
    points = [
        {"positions": READY, "time_from_start": 0.5},
        {"positions": moved(j1=0.3), "time_from_start": 1.5},
    ]
    step = {
        "kind": "trajectory",
        "name": POSITION,
        "request": {"joint_names": JOINTS, "points": points},
        "at": 0.0,
    }
    told = Rehearsals(ready(POSITION).facade).rehearse([step], certify=True)
    assert told.positions[-1][0] == pytest.approx(0.3, abs=0.01)
    assert told.certificate is not None


def creep(robot):
    """Give a set-point of a slow velocity, which seems to rest, by its certificate."""
    rehearsals = Rehearsals(robot.facade)
    [step] = set_point(VELOCITY, [0.004] + [0.0] * 6)
    name = rehearsals.rehearse([step], certify=True).certificate.name
    with rehearsals.redeemed(name, step) as ticket:
        robot.facade.motion.set_command(VELOCITY, step["values"], ticket=ticket)
    return robot.latest().position[0]


def test_a_set_point_without_an_end_is_watched_while_it_is_in_force(ready):
    robot = ready(VELOCITY)
    begin = creep(robot)
    robot.run(12.0)
    assert robot.facade.loop.stop_latch.state is StopState.STOPPED
    assert robot.latest().position[0] - begin == pytest.approx(0.03, abs=2e-3)


@pytest.mark.parametrize("end", ["another controller", "another set-point"])
def test_a_set_point_that_is_over_is_not_watched(ready, end):
    robot = ready(VELOCITY)
    creep(robot)
    robot.run(0.5)
    if end == "another controller":
        robot.switch(stop=[VELOCITY], start=[POSITION])
        robot.facade.motion.submit_goal(
            POSITION, goal(POSITION, moved(j1=0.3), 1.0)[0]["request"]
        )
    else:
        robot.facade.motion.set_command(VELOCITY, [0.2] + [0.0] * 6)
    robot.run(1.0)
    assert robot.latest().position[0] > 0.1
    assert robot.facade.loop.stop_latch.state is StopState.ARMED


def test_a_certificate_of_a_person_is_not_for_agents(ready):
    robot = ready(EFFORT)
    rehearsals = Rehearsals(robot.facade)
    name = rehearsals.rehearse(STEPS, certify=True).certificate.name
    with pytest.raises(CertificateVoidError, match="made for a person"):
        rehearsals.check_agent(name)
    with (
        pytest.raises(CertificateVoidError, match="made for a person"),
        rehearsals.redeemed(name, STEPS[0], is_agent=True),
    ):
        pytest.fail("the command was admitted")
    with rehearsals.redeemed(name, STEPS[0]):
        pass


def test_agents_need_a_certificate_and_people_do_not(ready):
    robot = ready(EFFORT)
    rules = Rules()
    rehearsals = Rehearsals(robot.facade, rules=rules)
    rehearsals.check(is_agent=False)
    with pytest.raises(RehearsalNeededError):
        rehearsals.check(is_agent=True)
    certificate = rehearsals.rehearse(STEPS, certify=True).certificate
    with rehearsals.redeemed(certificate.name, STEPS[0]):
        rehearsals.check(is_agent=True)
    assert rules.policy_of(is_agent=True) is Policy.REQUIRED


def test_a_motion_out_of_the_envelope_gets_no_certificate(ready):
    robot = ready(EFFORT)
    free = Rehearsals(robot.facade).rehearse(STEPS, certify=True, is_agent=True)
    assert free.certificate is not None
    fastest = max(free.joints, key=lambda one: one.velocity)
    name, end = fastest.joint, fastest.position
    begin = robot.facade.latest().position[robot.facade.joint_names.index(name)]
    middle = 0.5 * (begin + end)
    reach = abs(middle - begin)
    for envelope, text in [
        (Envelope(speed=0.9 * fastest.velocity), f"{name} reaches"),
        (Envelope(joints={name: (middle - reach, middle + reach)}), f"{name} comes to"),
        (Envelope(joints={name: (begin - 0.05, begin + 0.05)}), f"{name} comes to"),
    ]:
        bounded = Rehearsals(robot.facade, rules=Rules(envelope=envelope))
        told = bounded.rehearse(STEPS, certify=True, is_agent=True)
        assert told.outcome == "failed", text
        assert (told.error.cause, told.error.where) == ("envelope", name)
        assert text in told.error.text
        assert told.certificate is None
        persons = bounded.rehearse(STEPS, certify=True)
        assert persons.certificate is not None


def test_a_hand_keeps_to_the_workspace_of_agents(ready):
    robot = ready(EFFORT)
    state = robot.facade.robots.get("panda", FrankaServices).get_robot_state()
    x, _, z = state.O_T_EE[12:15]  # joint 1 at 0 turns the hand about the base's z

    def rehearsals(**workspace):
        envelope = Envelope(workspace=workspace)
        return Rehearsals(robot.facade, rules=Rules(envelope=envelope))

    told = rehearsals(y=(-0.1, 0.1)).rehearse(STEPS, certify=True, is_agent=True)
    assert (told.error.code, told.error.where) == ("outside_envelope", "panda")
    assert "The hand of panda comes to y = 0.1" in told.error.text
    first = np.interp(told.error.time, told.times, np.array(told.positions)[:, 0])
    assert x * np.sin(first) == pytest.approx(0.1, abs=2e-3)
    assert told.certificate is None
    free = rehearsals(x=(0.0, 1.0), z=(z - 0.02, z + 0.02))
    assert free.rehearse(STEPS, certify=True, is_agent=True).certificate is not None

    joint = robot.facade.joint_names[0]
    rehearsals(y=(-0.1, 0.1)).check_range(joint, 0.99 * np.arcsin(0.1 / x))
    with pytest.raises(AgentEnvelopeError, match="hand of panda comes to y"):
        rehearsals(y=(-0.1, 0.1)).check_range(joint, 1.01 * np.arcsin(0.1 / x))


def test_a_test_of_an_agent_keeps_to_the_ranges(ready):
    robot = ready(EFFORT)
    name = robot.facade.joint_names[0]
    q = robot.facade.latest().position[0]
    rules = Rules(envelope=Envelope(joints={name: (q - 0.1, q + 0.1)}))
    rehearsals = Rehearsals(robot.facade, rules=rules)
    rehearsals.check_range(name, 0.09)
    with pytest.raises(AgentEnvelopeError, match=f"{name} would move from"):
        rehearsals.check_range(name, 0.11)
    with pytest.raises(AgentEnvelopeError, match=f"{name} would move from -1e.300 to"):
        rehearsals.check_range(name, 1e300)
    anywhere = Rules(envelope=Envelope(workspace={"x": (-5.0, 5.0)}))
    Rehearsals(robot.facade, rules=anywhere).check_range(name, 1e300)
