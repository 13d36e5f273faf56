"""One time step of a world: what happens in which order, and what is left out."""

import pytest

from station.hw.mujoco.world_step import (
    GuardedPreparation,
    Preparation,
    SpeedCheck,
    WorldStep,
)
from station.memory.doubles import doubles


class Prepared(Preparation):
    """Notes that a step is prepared, and prepares it or not."""

    def __init__(self, done):
        self.done = done
        self.is_able = True

    def before(self):
        self.done.append("prepare")
        return self.is_able


class World:
    """Notes what is done in its steps."""

    def __init__(self):
        self.done = []
        self.speeds = doubles([0.0])
        self.step = WorldStep(
            lambda: self.done.append("step"),
            (0, 0, 0),
            SpeedCheck(self.speeds, doubles([1.0])),
            lambda: self.done.append("brake"),
            lambda: self.done.append("count pushes"),
        )
        self.preparation = Prepared(self.done)
        fallback = lambda: self.done.append("fallback")  # noqa: E731
        guarded = GuardedPreparation(self.preparation, fallback)
        self.step.preparations.append(guarded)


@pytest.fixture
def world():
    return World()


def test_a_step_is_prepared_and_made(world):
    world.step.make_step()
    assert world.done == ["prepare", "step"]
    assert world.step.count == 1


def test_a_step_that_a_preparation_leaves_has_a_fallback(world):
    world.preparation.is_able = False
    world.step.is_pushed = True
    world.step.make_step()
    assert world.done == ["prepare", "fallback", "count pushes", "step"]


@pytest.mark.parametrize("speed", [1.1, -1.1, float("nan"), float("inf")])
def test_an_impossible_speed_is_braked(world, speed):
    world.speeds[0] = speed
    world.step.make_step()
    assert world.done == ["prepare", "step", "brake"]


def test_brakes_are_called_once_more_after_they_acted(world):
    world.step.is_braked = True
    world.step.make_step()
    assert world.done[-1] == "brake"


def test_a_world_that_stands_still_counts_its_steps(world):
    world.step.stands_still = True
    world.step.make_step()
    assert (world.done, world.step.count) == ([], 1)


def test_what_a_fallback_raises_reaches_the_caller(world):
    def fail():
        raise RuntimeError("no motor")

    preparation = GuardedPreparation(Preparation(), fail)
    world.step.preparations.append(preparation)
    with pytest.raises(RuntimeError, match="no motor"):
        world.step.make_step()
    assert "step" not in world.done
