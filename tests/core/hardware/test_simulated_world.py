"""A world that says nothing else is empty and never waits for the loop."""

from math import inf

import pytest

from station.core.hardware.robot_hw import SimulatedWorld


class Clockwork(SimulatedWorld):
    """A world with the least that a world must have."""

    def time(self):
        return 1.0

    def reset(self, positions):
        raise AssertionError(positions)


def test_world_is_empty_and_never_waits_by_default():
    assert list(Clockwork().scene()) == []
    assert list(Clockwork().contacts()) == []
    assert Clockwork().longest_period() == inf


def test_world_without_a_reset_cannot_be_constructed():
    with pytest.raises(TypeError, match="reset"):
        type("Endless", (SimulatedWorld,), {"time": lambda _: 0.0})()
