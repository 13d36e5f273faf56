"""One time step of a world: what happens in which order, and what is left out."""

import pytest

from station.hw.mujoco.speed_check import SpeedCheck
from station.hw.mujoco.world_step import (
    AttendedPreparation,
    CalledPreparation,
    WorldStep,
)
from station.memory.doubles import doubles


class World:
    """Notes what is done in its steps."""

    def __init__(self):
        self.done = []
        self.is_usual = True
        self.speeds = doubles([0.0])
        self.step = WorldStep(
            lambda: self.done.append("step"),
            (0, 0, 0),
            SpeedCheck(self.speeds, doubles([1.0])),
            lambda: self.done.append("look"),
            lambda: self.done.append("count pushes"),
        )
        preparation = CalledPreparation(self.prepare)
        attend = lambda: self.done.append("attend")  # noqa: E731
        self.step.preparations.append(AttendedPreparation(preparation, attend))

    def prepare(self):
        self.done.append("prepare")
        return self.is_usual


@pytest.fixture
def world():
    return World()


def test_a_usual_step_is_prepared_and_made(world):
    world.step.make()
    assert world.done == ["prepare", "step"]
    assert world.step.count == 1


def test_what_is_no_usual_step_is_attended_to_before_it(world):
    world.is_usual = False
    world.step.is_pushed = True
    world.step.make()
    assert world.done == ["prepare", "attend", "count pushes", "step"]


@pytest.mark.parametrize("speed", [1.1, -1.1, float("nan"), float("inf")])
def test_an_impossible_speed_is_looked_at(world, speed):
    world.speeds[0] = speed
    world.step.make()
    assert world.done == ["prepare", "step", "look"]


def test_brakes_are_looked_at_once_more_after_they_acted(world):
    world.step.is_braked = True
    world.step.make()
    assert world.done[-1] == "look"


def test_a_world_that_stands_still_counts_its_steps(world):
    world.step.stands_still = True
    world.step.make()
    assert (world.done, world.step.count) == ([], 1)


def test_what_a_preparation_raises_reaches_the_caller(world):
    def fail():
        raise RuntimeError("no motor")

    preparation = AttendedPreparation(CalledPreparation(fail), lambda: None)
    world.step.preparations.append(preparation)
    with pytest.raises(RuntimeError, match="no motor"):
        world.step.make()
    assert "step" not in world.done
