"""What each topic tells."""

import asyncio

import pytest

from station.api.streams.topics import find_topic, topic_names
from station.core.control.switching import SwitchRequest
from station.core.errors import LoopError
from station.core.franka.arms import Arms
from tests.api.spring import make_station
from tests.franka_station import make_franka_station


@pytest.fixture
def station():
    station = make_station()
    station.load_controller("spring", "test/Spring", {"joint": "j"})
    return station


def latest(station, name):
    async def ask():
        return await find_topic(station, name).latest()

    return asyncio.run(ask())


def test_all_topics_are_named(station):
    names = topic_names(station)

    fixed = ["joint_states", "controllers", "loop", "scene"]
    assert names == [*fixed, "controller_state/spring"]
    assert all(find_topic(station, name) is not None for name in names)


def test_arms_tell_their_whole_state():
    station = make_franka_station()
    data = latest(station, "robot_state/panda").data

    assert "robot_state/panda" in topic_names(station)
    assert set(data) == set(find_topic(station, "robot_state/panda").fields)
    assert (data["arm_id"], data["robot_mode"]) == ("panda", "idle")
    assert data["q"] == Arms(station.robots).state("panda").q
    assert find_topic(station, "robot_state").name == "robot_state/panda"


@pytest.mark.parametrize("name", ["robot_state", "robot_state/left", "robot_state/"])
def test_arms_that_are_not_there_have_no_topic(station, name):
    assert find_topic(station, name) is None


def test_before_the_first_cycle_there_are_no_joints(station):
    assert latest(station, "joint_states") is None


def test_joints_are_those_of_the_last_cycle(station):
    station.loop.step(3)
    payload = latest(station, "joint_states")

    assert (payload.cycle, payload.epoch, payload.stamp) == (3, 1, 0.003)
    assert payload.data == {
        "stamp": 0.003,
        "name": ["j"],
        "position": [0.25],
        "velocity": [0.0],
        "effort": [0.0],
    }


def test_a_controller_tells_while_it_runs(station):
    station.loop.step()
    assert latest(station, "controller_state/spring") is None

    station.switch_controllers(SwitchRequest(start=("spring",)))
    station.loop.step()
    data = latest(station, "controller_state/spring").data
    assert data["name"] == ["j"]
    assert data["desired"] == data["actual"] == [0.25]


def test_a_controller_that_was_unloaded_falls_silent(station):
    topic = find_topic(station, "controller_state/spring")
    station.unload_controller("spring")
    station.loop.step()

    assert asyncio.run(topic.latest()) is None
    assert topic.names() == ["j"]


def test_the_list_of_controllers(station):
    (controller,) = latest(station, "controllers").data["controllers"]

    assert controller["name"] == "spring"
    assert controller["state"] == "initialized"


def test_the_loop_comes_with_the_stop(station):
    data = latest(station, "loop").data

    assert data["loop"]["state"] == "stopped"
    assert data["stop"]["state"] == "armed"
    assert data["robot_mode"]


def test_a_report_that_cannot_be_had_is_left_out(station, monkeypatch):
    def fail():
        raise LoopError("dead")

    monkeypatch.setattr(station, "controllers", fail)
    assert latest(station, "controllers") is None


def test_batches_go_on_where_the_client_is(station):
    station.loop.step(10)
    topic = find_topic(station, "joint_states")

    first = topic.since(2, limit=5)
    assert [s["cycle"] for s in first.data["samples"]] == [3, 4, 5, 6, 7]
    assert (first.cycle, first.data["lost"]) == (7, 0)
    rest = topic.since(first.cycle, limit=50)
    assert [s["cycle"] for s in rest.data["samples"]] == [8, 9, 10]
    assert topic.since(10, limit=50) is None


def test_a_batch_says_how_many_cycles_were_overwritten(station):
    station.loop.step(5000)
    topic = find_topic(station, "joint_states")

    batch = topic.since(100, limit=10)

    first = batch.data["samples"][0]["cycle"]
    assert batch.data["lost"] == first - 101 > 0
