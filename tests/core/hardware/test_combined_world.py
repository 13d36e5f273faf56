"""Several simulated worlds are asked as one."""

from math import inf

import pytest

from station.core.hardware.combined_world import CombinedWorld
from station.core.hardware.robot_report import SceneObjectReport
from station.core.parameters import Parameters, ParameterTree
from station.hw.mock import MockRobotHW


def thing(name: str) -> SceneObjectReport:
    return SceneObjectReport(name, "box", (), (), (), 1.0, "")


@pytest.fixture
def robots():
    made = []
    for joint in ("left", "right"):
        robot = MockRobotHW()
        params = Parameters(ParameterTree({"joints": [joint]}))
        robot.init(params, params)
        made.append(robot)
    return made


@pytest.fixture
def world(robots):
    return CombinedWorld([(robot, robot.simulated_world()) for robot in robots])


def test_reset_puts_every_joint_into_its_own_world(robots, world):
    robots[0].simulated_world().advance(0.5)
    assert world.time() == 0.5

    world.reset({"right": 0.3})

    assert world.time() == 0.0
    assert [robot.joints.position for robot in robots] == [[0.0], [0.3]]


def test_contacts_of_all_worlds_are_told(robots, world, monkeypatch):
    assert world.contacts() == []
    for robot, name in zip(robots, "ab", strict=True):
        monkeypatch.setattr(robot.simulated_world(), "contacts", lambda n=name: [n])
    assert world.contacts() == ["a", "b"]


def test_moving_bases_of_all_worlds_are_told(robots, world, monkeypatch):
    assert world.bases() == []
    for robot, name in zip(robots, "ab", strict=True):
        monkeypatch.setattr(robot.simulated_world(), "bases", lambda n=name: [n])
    assert world.bases() == ["a", "b"]


def test_objects_of_one_name_are_one_object(robots, world, monkeypatch):
    assert world.scene() == []
    for robot, names in zip(robots, ("ab", "bc"), strict=True):
        things = [thing(name) for name in names]
        monkeypatch.setattr(robot.simulated_world(), "scene", lambda t=things: t)

    assert [one.name for one in world.scene()] == ["a", "b", "c"]


def test_station_waits_no_longer_than_every_world_does(robots, world, monkeypatch):
    first, second = (robot.simulated_world() for robot in robots)
    monkeypatch.setattr(first, "longest_period", lambda: 0.02)
    assert world.longest_period() == inf
    monkeypatch.setattr(second, "longest_period", lambda: 0.05)
    assert world.longest_period() == 0.05
