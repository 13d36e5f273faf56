"""The client for plain Python: the same methods, which wait."""

import asyncio
import gc
import inspect
import subprocess
import sys
import threading
import warnings
from concurrent.futures import Future

import httpx
import pytest

from station.api.app import create_app
from station.api.auth import Authenticator
from station.api.server import ApiServer
from station.client import (
    ApiError,
    StationClient,
    StationUnreachableError,
    StreamTimeoutError,
    blocking,
    controllers,
    lease,
    robots,
    station_client,
    stores,
    streams,
)
from station.core.franka.arms import Arms
from station.reports import examples_of
from station.wire import JointStates, SwitchResult
from tests.api.conftest import OPERATOR
from tests.api.spring import make_station
from tests.franka_station import make_franka_station
from tests.waiting import PATIENCE


def test_nobody_there_is_said_plainly():
    with (
        StationClient("http://127.0.0.1:9", timeout=1.0) as client,
        pytest.raises(StationUnreachableError, match=r"127\.0\.0\.1:9"),
    ):
        client.health()


def test_a_silent_server_is_given_up():
    def wait(request):
        raise httpx.ReadTimeout("timed out", request=request)

    with (
        StationClient("http://a", "t", transport=httpx.MockTransport(wait)) as client,
        pytest.raises(StationUnreachableError, match="timed out"),
    ):
        client.status()


def test_a_switch_waits_for_its_own_timeout_too():
    seen = []

    def answer(request):
        seen.append(request.extensions["timeout"]["read"])
        (example,) = examples_of(SwitchResult.__doc__)
        return httpx.Response(200, json=example)

    with StationClient(
        "http://a", "t", transport=httpx.MockTransport(answer), timeout=3.0
    ) as client:
        client.switch_controllers(start=["a"], timeout=5.0)
        client.switch_controllers(start=["a"])
        client.switch_controllers(start=["a"], bound=20.0)
        client.switch_controllers(start=["a"], bound=None)

    assert seen == [8.0, 8.0, 23.0, None]


def test_keys_of_a_newer_station_are_ignored():
    def answer(_):
        return httpx.Response(200, json={"status": "ok", "boot_id": "b", "new": 1})

    with StationClient(
        "http://a", "t", transport=httpx.MockTransport(answer)
    ) as client:
        assert client.health().boot_id == "b"


def test_proxies_of_the_environment_are_not_used(monkeypatch, served):
    monkeypatch.setenv("HTTP_PROXY", "http://127.0.0.1:9")
    monkeypatch.setenv("ALL_PROXY", "http://127.0.0.1:9")

    with StationClient(served.url) as client:
        assert client.health().status == "ok"
        with pytest.raises(ApiError) as caught:
            client.status()
    assert caught.value.status == 401


def test_requests_and_streams_are_encrypted_for_whoever_trusts_the_station(
    encrypted, tls
):
    with StationClient(encrypted.url, OPERATOR, ca=str(tls.certificate)) as client:
        client.load_controller("spring", "test/Spring", {"joint": "j"})
        client.switch_controllers(start=["spring"])
        with client.stream("joint_states") as stream:
            assert stream.progress.connected
        with client.command_stream("spring") as commands:
            commands.send([0.5])
        assert "running: spring" in client._repr_html_()


def test_a_station_that_is_not_trusted_is_told_nothing(encrypted, monkeypatch):
    monkeypatch.delenv("STATION_CA", raising=False)
    with StationClient(encrypted.url, OPERATOR) as client:
        with pytest.raises(StationUnreachableError, match="CERTIFICATE_VERIFY") as no:
            client.session()
        with pytest.raises(StationUnreachableError), client.stream("loop"):
            pass
    assert "--ca" in no.value.remedy


def test_a_key_of_a_request_reaches_the_station(served):
    with StationClient(served.url, OPERATOR) as client:
        client.load_controller("spring", "test/Spring", {"joint": "j"})
        for _ in range(2):
            state = client.unload_controller("spring", idempotency_key="once")
            assert state.name == "spring"
        assert client.controllers() == []


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
    monkeypatch.setattr(streams, "FIRST_DELAY", 0.01)
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
    assert first.wait(PATIENCE)
    stream.close()
    reader.join(PATIENCE)

    assert not reader.is_alive()
    assert seen
    gc.collect()  # a connection that is left open is an error here, and not later


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

        frame = stream.wait_for(lambda frame: frame.stamp > 0.0, PATIENCE)

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


def twins():
    """Return the classes of the blocking client with those they wait for."""
    modules = (controllers, lease, robots, station_client, stores, streams)
    sources = {
        name.removeprefix("Async"): kind
        for module in modules
        for name, kind in vars(module).items()
        if name.startswith("Async") and kind.__module__ == module.__name__
    }
    del sources["ControllersClient"]  # it is a part of the station's
    return [(getattr(blocking, name), source) for name, source in sources.items()]


def methods(client):
    """Return the arguments of the public methods; properties have none."""
    members = inspect.getmembers(client, inspect.isfunction)
    return {
        name: str(inspect.signature(member)).partition(" ->")[0]
        for name, member in members
        if not name.startswith("_")
    }


@pytest.mark.parametrize(("client", "source"), twins())
def test_both_clients_have_the_same_methods(client, source):
    own = methods(client)
    theirs = methods(source)
    # They wait in the loop of streams.
    for name in ("collect", "link", "post") if "Stream" in client.__name__ else ():
        theirs.pop(name, None)

    assert own == theirs
    assert own


def test_all_classes_are_compared():
    assert len(twins()) == 23


def test_a_coroutine_that_needs_a_loop_is_a_defect():
    async def wait():
        await asyncio.sleep(0)

    with pytest.raises(RuntimeError, match="waits for an event loop"):
        blocking._run(wait())


def test_ctrl_c_ends_a_wait_for_a_frame(client, monkeypatch):
    def interrupt(_):
        raise KeyboardInterrupt

    with client.stream("joint_states") as stream:
        stream.receive(5.0)
        with monkeypatch.context() as patch:
            patch.setattr(Future, "result", interrupt)
            with pytest.raises(KeyboardInterrupt):
                stream.wait_for(lambda _: False)
        assert stream.receive(5.0).topic == "joint_states"


ENDS = """
import os, sys
from station.client import StationClient
client = StationClient(sys.argv[1], sys.argv[2])
frames = iter(client.stream("joint_states"))
next(frames)
child = os.fork()
if child == 0:
    with StationClient(sys.argv[1], sys.argv[2]).stream("joint_states") as stream:
        stream.receive(5.0)
    os._exit(7)
print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""


def test_a_fork_has_streams_and_one_left_open_does_not_hold_up_the_end(served):
    # The wait for the process is long: what other tests left is collected before, so
    # that its warnings are not taken for this test's.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)
        gc.collect()
    command = [sys.executable, "-c", ENDS, served.url, OPERATOR]
    ended = subprocess.run(command, capture_output=True, timeout=60.0, check=True)

    assert (ended.stdout, ended.stderr) == (b"7\n", b"")
