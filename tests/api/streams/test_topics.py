"""What each topic tells."""

import asyncio

import pytest

from station.api.streams.topics import find_topic, topic_names
from station.core.control.switching import SwitchRequest
from station.core.errors import LoopError
from station.core.franka.arms import Arms
from station.events import EventLog
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
    assert names == [*fixed, "events", "controller_state/spring"]
    log = EventLog()
    assert all(find_topic(station, name, log) is not None for name in names)


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


def full(station, name, cycles, act=lambda: None):
    """Return the batch of every cycle of a topic while the station steps."""
    samples = find_topic(station, name).every_cycle()
    samples.open()
    begin = samples.newest_cycle()
    for _ in range(cycles):
        station.loop.step()
        act()
    batch = samples.since(begin, samples.newest_cycle())
    samples.close()
    return batch


def test_every_topic_has_a_sample_of_every_cycle(station):
    station.loop.step(3)
    station.switch_controllers(SwitchRequest(start=("spring",)))
    for name in set(topic_names(station)) - {"events"}:
        before = station.loop.cycle
        batch = full(station, name, 4)

        cycles = [sample["cycle"] for sample in batch.data["samples"]]
        assert cycles == [before + n for n in (1, 2, 3, 4)], name
        assert (batch.data["lost"], batch.data["skipped"]) == (0, 0)
        keys = {"cycle", *find_topic(station, name).sample_fields} - {"name", "arm_id"}
        assert all(set(sample) == keys for sample in batch.data["samples"]), name
        assert batch.cycle == cycles[-1]
    assert station.loop.control_cycle.taps == ()


def test_the_controllers_that_run_are_told_for_every_cycle(station):
    station.loop.step()
    start = SwitchRequest(start=("spring",))

    def start_once():
        if not station.manager.running_names():
            station.switch_controllers(start)

    batch = full(station, "controllers", 2, start_once)

    running = [sample["running"] for sample in batch.data["samples"]]
    assert running[0] == []
    assert running[-1] == ["spring"]


def test_a_sample_of_the_loop_has_the_period(station):
    station.loop.step()
    station.loop.delay_next_cycle(19)
    batch = full(station, "loop", 2)

    periods = [sample["period"] for sample in batch.data["samples"]]
    assert periods == [pytest.approx(0.020), 0.001]
    assert batch.data["skipped"] == 19


def test_an_arm_tells_the_same_in_every_cycle_as_when_it_is_asked():
    station = make_franka_station()
    batch = full(station, "robot_state", 3)
    asked = latest(station, "robot_state").data

    last = batch.data["samples"][-1]
    del asked["arm_id"], last["cycle"], last["stamp"]
    assert batch.data["arm_id"] == "panda"
    assert last == asked
