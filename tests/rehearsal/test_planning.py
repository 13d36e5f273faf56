"""A plan leads around what is in the way, or the refusal says why there is none."""

from itertools import pairwise

import numpy as np
import pytest

import station
from station.core.description.urdf import Pose
from station.core.errors import (
    InvalidCommandError,
    InvalidTrajectoryError,
    NoPathError,
)
from station.core.franka.arms import Arms
from station.rehearsal.path_search import PathSearch
from station.rehearsal.planning import PoseJudge, Wish
from station.rehearsal.rehearsals import Rehearsals
from tests.rehearsal.cluttered_scenes import Scene

ARM = "position_joint_trajectory_controller"
JOINTS = [f"panda_joint{i}" for i in range(1, 8)]
BEGIN = [-0.9, -0.2, 0.0, -2.0, 0.0, 1.571, 0.785]
BEHIND = {"panda_joint1": 0.9}


def box(name, size, position):
    return {"name": name, "type": "box", "size": size, "position": position}


SCENES = {
    "post": [box("post", [0.08, 0.08, 1.0], [0.42, 0.0, 0.5])],
    "low wall": [box("wall", [0.5, 0.05, 0.5], [0.5, 0.0, 0.25])],
    "beam and box": [
        box("beam", [0.1, 0.1, 0.1], [0.45, 0.0, 0.75]),
        box("box", [0.2, 0.2, 0.4], [0.5, 0.0, 0.2]),
    ],
}


def at_begin(scene):
    robot = station.open({"scene": {"objects": scene}})
    robot.reset(dict(zip(JOINTS, BEGIN, strict=True)))
    robot.run(0.05)
    robot.switch(start=[ARM])
    robot.run(0.05)
    return robot


@pytest.mark.parametrize("scene", SCENES)
def test_planned_path_is_followed_without_a_contact(scene):
    robot = at_begin(SCENES[scene])
    found = Rehearsals(robot.facade).plan(Wish(ARM, BEHIND))
    world = robot.facade.loop.hw.simulated_world()
    goal = robot.facade.motion.submit_goal(ARM, found.goal)
    touched = set()
    for _ in range(int(1000 * found.duration) + 500):
        robot.step()
        touched |= {one.bodies for one in world.contacts()}
    assert goal.status.value == "succeeded"
    assert not touched
    assert robot.positions()["panda_joint1"] == pytest.approx(0.9, abs=0.01)


def test_refusal_says_which_bodies_or_which_joint():
    robot = at_begin(SCENES["post"])
    rehearsals = Rehearsals(robot.facade)
    with pytest.raises(NoPathError, match="post") as touching:
        rehearsals.plan(Wish(ARM, {"panda_joint1": 0.0}))
    assert touching.value.details["cause"] == "goal_in_collision"
    assert "post" in touching.value.details["pair"]
    with pytest.raises(InvalidTrajectoryError, match="panda_joint1 cannot go to 9"):
        rehearsals.plan(Wish(ARM, {"panda_joint1": 9.0}))
    with pytest.raises(NoPathError, match="No path was found"):
        rehearsals.plan(Wish(ARM, BEHIND, timeout=0.001))


def end_effector(robot):
    arms = Arms(robot.facade.robots)
    return np.array(arms.state("panda").O_T_EE)


def test_planned_pose_is_reached_around_a_post():
    robot = at_begin(SCENES["post"])
    pose = end_effector(robot)
    # The mirror image on the other side of the post.
    place = ([pose[12], -pose[13], pose[14]], None)
    found = Rehearsals(robot.facade).plan(Wish(ARM, place=place))
    goal = robot.facade.motion.submit_goal(ARM, found.goal)
    robot.run(found.duration + 0.5)
    assert goal.status.value == "succeeded"
    reached = end_effector(robot)
    assert reached[12:15] == pytest.approx(place[0], abs=2e-3)
    assert reached[:11] == pytest.approx(pose[:11], abs=5e-3)


def test_refusal_of_a_pose_says_how_far_or_which_bodies():
    robot = at_begin(SCENES["post"])
    rehearsals = Rehearsals(robot.facade)
    with pytest.raises(NoPathError, match="cannot get there") as far:
        rehearsals.plan(Wish(ARM, place=([1.5, 0.0, 0.5], None)))
    assert far.value.details["cause"] == "unreachable"
    # 0.855 m from the shoulder at a height of 0.333 m to the wrist, and the hand.
    assert 0.3 < far.value.details["distance"] < 0.9
    with pytest.raises(NoPathError, match="post") as touching:
        rehearsals.plan(Wish(ARM, place=([0.42, 0.0, 0.6], None)))
    assert "post" in touching.value.details["pair"]
    with pytest.raises(InvalidCommandError, match="no pose 'reddy'"):
        rehearsals.plan(Wish(ARM, name="reddy"))


def test_planned_way_leads_to_a_pose_that_has_a_name():
    robot = at_begin([])
    found = Rehearsals(robot.facade).plan(Wish(ARM, name="ready"))
    assert found.positions[-1][3] == pytest.approx(-2.356, abs=1e-3)


def test_planned_path_keeps_clear_of_a_place_that_nothing_touches():
    robot = at_begin([])
    place = {**SCENES["post"][0], "role": "keep_out", "margin": 0.02}
    robot.facade.surroundings.put("post", {k: place[k] for k in place if k != "name"})
    found = Rehearsals(robot.facade).plan(Wish(ARM, BEHIND, timeout=20.0))
    goal = robot.facade.motion.submit_goal(ARM, found.goal)
    least = 1.0
    for _ in range(int(1000 * found.duration) + 300):
        robot.step()
        least = min(least, robot.facade.surroundings.clearance("panda").distance)
    assert not found.direct
    assert goal.status.value == "succeeded"
    assert least >= 0.02
    with pytest.raises(NoPathError, match="post") as touching:
        Rehearsals(robot.facade).plan(Wish(ARM, {"panda_joint1": 0.0}))
    assert "post" in touching.value.details["pair"]


def test_what_a_hand_carries_counts_as_a_part_of_it():
    # The hand passes 0.15 m above the block; the stick reaches 0.12 m farther down.
    stick = {**box("stick", [0.01, 0.01, 0.2], [0.0, 0.0, 0.0]), "mass": 0.05}
    robot = at_begin([stick, box("block", [0.1, 0.1, 0.4], [0.42, 0.0, 0.2])])
    over = np.array([0.0, *BEGIN[1:]])
    world = robot.facade.loop.hw.simulated_world()
    hand = robot.facade.surroundings._guards[0].hand()
    x, y, z = hand.compose(Pose((0.0, 0.0, 0.24))).xyz
    robot.facade.surroundings.put("stick", {"position": [x, y, z]})
    assert PoseJudge(robot.facade, JOINTS, np.array(BEGIN)).is_clear(over)
    world.nearness(JOINTS, 0.01)(BEGIN)
    robot.facade.surroundings.attach("stick", load=False)
    judge = PoseJudge(robot.facade, JOINTS, np.array(BEGIN))
    assert {"stick", "block"} in [{*pair[:2]} for pair in judge.blocked(over)]
    # Turned by the first joint, it is where the hand has taken it.
    for q1 in (-0.9, 0.4, 0.0):
        judge.is_clear(np.array([q1, *BEGIN[1:]]))
        here = next(one for one in world.scene() if one.name == "stick").position
        angle = q1 - BEGIN[0]
        turned = Pose.from_rpy((0.0, 0.0, 0.0), (0.0, 0.0, angle)).compose(
            Pose((x, y, z))
        )
        assert here == pytest.approx(turned.xyz, abs=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 15, 42])
def test_ways_through_clutter_are_found_and_clear(seed):
    assert Scene.of(seed).follow() == (True, set())


def test_search_finds_the_gap_of_a_wall():
    def is_clear(pose):
        return not (0.4 < pose[0] < 0.6 and abs(pose[1] - 0.8) > 0.1)

    search = PathSearch(is_clear, np.zeros(2), np.ones(2), seed=1)
    path = search.find(np.array([0.1, 0.1]), [np.array([0.9, 0.1])], np.inf)
    for one, other in pairwise(path):
        for share in np.linspace(0.0, 1.0, 200):
            x, y = one + share * (other - one)
            assert not (0.41 < x < 0.59 and abs(y - 0.8) > 0.12)


def test_free_way_is_straight():
    search = PathSearch(lambda _: True, np.zeros(2), np.ones(2), seed=1)
    start, goal = np.array([0.1, 0.1]), np.array([0.9, 0.4])
    assert search.find(start, [goal], np.inf) == [start, goal]
