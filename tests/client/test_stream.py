"""The stream for plain Python: frames, reconnection, refusals."""

import threading

import pytest

from station.api.app import create_app
from station.api.auth import Authenticator
from station.api.server import ApiServer
from station.client import (
    ApiError,
    StationClient,
    StationUnreachableError,
    StreamTimeoutError,
    stream_options,
)
from station.core.franka.arms import Arms
from station.wire import JointStates
from tests.api.conftest import OPERATOR
from tests.api.spring import make_station
from tests.franka_station import make_franka_station


@pytest.fixture
def client(served):
    with StationClient(served.url, OPERATOR) as client:
        yield client


def test_frames_come_without_the_hello(client, station):
    with client.stream("joint_states", rate=100, fields=["position"]) as stream:
        frames = iter(stream)
        frame = next(frames)

        assert frame.topic == "joint_states"
        assert frame.data == {"position": [0.25]}
        assert frame.boot_id == station.boot_id
        assert stream.progress.connected
        assert stream.progress.snapshot()["controllers"] == []
        frames.close()
    assert not stream.progress.connected


def test_whole_state_of_an_arm_is_streamed():
    station = make_franka_station()
    app = create_app(station, Authenticator(OPERATOR))
    with (
        ApiServer(app, port=0) as server,
        StationClient(server.url, OPERATOR) as client,
        client.stream("robot_state/panda", rate=50) as stream,
    ):
        frames = iter(stream)
        data = next(frames).data
        frames.close()

    assert data["arm_id"] == "panda"
    assert data["O_T_EE"] == pytest.approx(Arms(station.robots).state("panda").O_T_EE)


def test_every_cycle(client, station):
    with client.stream("joint_states", rate="full") as stream:
        frames = iter(stream)
        threading.Thread(target=step_until, args=(stream, station)).start()
        assert next(frames).data["lost"] == 0


def step_until(stream, station):
    while not stream.progress.connected:
        pass
    station.loop.step(5)


@pytest.mark.parametrize(
    ("token", "topic", "status"),
    [("wrong", "loop", 4401), (OPERATOR, "nothing", 4404)],
)
def test_a_refusal_is_raised_not_retried(served, token, topic, status):
    with StationClient(served.url, token) as client:
        with pytest.raises(ApiError) as caught:
            next(iter(client.stream(topic)))
        with pytest.raises(ApiError), client.stream(topic):
            pass

    assert caught.value.status == status
    assert caught.value.remedy


def test_without_reconnection_a_broken_link_is_an_error(client, served):
    with client.stream("joint_states", reconnect=False) as stream:
        frames = iter(stream)
        next(frames)
        served.stop()
        with pytest.raises(StationUnreachableError):
            list(frames)


def test_a_stream_survives_a_restart_of_the_station(client, served, monkeypatch):
    monkeypatch.setattr(stream_options, "FIRST_DELAY", 0.01)
    with client.stream("joint_states") as stream:
        frames = iter(stream)
        before = next(frames)
        served.stop()
        other = make_station()
        other.loop.step()
        app = create_app(other, Authenticator(OPERATOR))
        with ApiServer(app, port=served.port):
            after = next(frame for frame in frames if frame.boot_id != before.boot_id)

    assert after.boot_id == other.boot_id
    assert stream.progress.connections == 2


def test_close_ends_an_iteration_in_another_thread(client):
    stream = client.stream("joint_states")
    seen = []

    def read():
        for frame in stream:
            seen.append(frame)
            first.set()

    first = threading.Event()
    reader = threading.Thread(target=read)
    reader.start()
    assert first.wait(5.0)
    stream.close()
    reader.join(5.0)

    assert not reader.is_alive()
    assert seen


def test_entering_connects_at_once(client):
    with client.stream("joint_states") as stream:
        assert stream.progress.connected


def test_entering_raises_when_nobody_answers():
    stream = StationClient("http://127.0.0.1:9", OPERATOR).stream("loop")
    with pytest.raises(StationUnreachableError), stream:
        pass


def test_frame_that_fulfils_a_condition_is_waited_for(client, station):
    with client.stream("joint_states", rate="full") as stream:
        station.loop.step(3)

        frame = stream.wait_for(lambda frame: frame.stamp > 0.0, 5.0)

        assert frame.data["samples"]


def test_waiting_ends_in_time(client):
    with client.stream("joint_states") as stream:
        with pytest.raises(StreamTimeoutError, match=r"no such frame within 0\.05 s"):
            stream.wait_for(lambda _: False, 0.05)
        assert stream.receive(5.0).topic == "joint_states"


def test_frame_is_read_as_a_wire_model(client):
    with client.stream("joint_states") as stream:
        joints = stream.receive(5.0).read(JointStates)

    assert joints.position == [0.25]
