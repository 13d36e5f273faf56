"""Links that are pulled with the pointer."""

import asyncio
from types import SimpleNamespace

import pytest

from station.client import ApiError
from station.core.description.urdf import Pose
from station.ui.link.station_view import ArmFacts
from station.ui.scene.layers.drag_layers import (
    ALIVE_FOR,
    PUSH_PERIOD,
    PUSH_TIME,
    STIFFNESS,
    STRONGEST,
    Pushing,
    PushLayer,
    pull_force,
)
from station.ui.scene.layers.layer import SceneFacts

FACTS = SceneFacts(arms={"panda": ArmFacts(Pose(), Pose(), None)})
GRIP = (0.1, 0.0, 0.9)


class _Station:
    """Takes pushes; time passes when a test says so."""

    def __init__(self):
        self.time = 10.0
        self.sent = []
        self.refusal = None
        self.refused = []

    async def push(self, key, arm_id, push):
        if self.refusal:
            raise self.refusal
        self.sent.append((key, arm_id, push))


@pytest.fixture
def station():
    return _Station()


@pytest.fixture
def layer(client, panda, station):
    pushing = Pushing(
        station.push,
        lambda error, _: station.refused.append(error.code),
        lambda: station.time,
    )
    layer = PushLayer(client, [panda], pushing, "mine")
    yield layer
    layer.remove()


def _drag(layer, panda, phase="update", pointer=(0.1, 0.0, 1.1), link="panda_hand"):
    event = SimpleNamespace(phase=phase, start_position=GRIP, end_position=pointer)
    return layer._on_drag(panda, link, event)


async def _look(layer, station, seconds=1.01 * PUSH_PERIOD):
    station.time += seconds
    layer.show(FACTS)
    await asyncio.sleep(0)


def test_a_held_link_is_pushed_again_and_again_for_a_short_time(layer, panda, station):
    async def pull():
        await _look(layer, station)
        await _drag(layer, panda, "start")
        for _ in range(3):
            layer.alive()
            await _look(layer, station)
        await _drag(layer, panda, "end")
        await _look(layer, station)

    asyncio.run(pull())
    assert len(station.sent) == 3
    key, arm_id, push = station.sent[0]
    assert (key, arm_id, push.link) == ("mine", "panda", "panda_hand")
    assert push.duration == PUSH_TIME < 3 * PUSH_PERIOD
    assert push.force == pytest.approx([0.0, 0.0, 0.2 * STIFFNESS], abs=1e-6)


def test_a_push_ends_when_the_page_says_no_more_that_it_lives(layer, panda, station):
    async def pull():
        layer.alive()
        await _look(layer, station)
        await _drag(layer, panda, "start")
        await _look(layer, station, 0.5 * ALIVE_FOR)
        await _look(layer, station, ALIVE_FOR)
        await _look(layer, station, PUSH_PERIOD)

    asyncio.run(pull())
    assert len(station.sent) == 1


def test_a_refused_push_is_told_and_ends(layer, panda, station):
    station.refusal = ApiError("No.", status=423, code="control_taken")

    async def pull():
        layer.alive()
        await _look(layer, station)
        await _drag(layer, panda, "start")
        await _look(layer, station)
        await asyncio.sleep(0)
        await _look(layer, station)

    asyncio.run(pull())
    assert station.refused == ["control_taken"]


def test_a_robot_that_is_no_arm_of_the_station_is_not_pushed(layer, panda, station):
    async def pull():
        layer.alive()
        layer.show(SceneFacts())
        await _drag(layer, panda, "start")
        layer.show(SceneFacts())
        await asyncio.sleep(0)

    asyncio.run(pull())
    assert station.sent == []


def test_a_force_grows_with_the_distance_up_to_a_bound():
    assert pull_force((0.0, 0.0, 0.0), (0.1, 0.0, 0.0)) == (8.0, 0.0, 0.0)
    assert pull_force((0.0, 0.0, 0.0), (0.0, 5.0, 0.0)) == (0.0, STRONGEST, 0.0)
    assert pull_force((1.0, 1.0, 1.0), (1.0, 1.0, 1.0)) == (0.0, 0.0, 0.0)
