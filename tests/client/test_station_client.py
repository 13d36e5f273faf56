"""The client for asyncio, at a served station."""

import asyncio

import httpx
import numpy as np
import pytest

from station.api.app import create_app
from station.api.auth import Authenticator
from station.api.server import ApiServer
from station.client import (
    ApiError,
    AsyncStationClient,
    AsyncStream,
    StationClient,
    StationUnreachableError,
)
from station.client.station_client import summary_html
from station.wire import StreamFrame
from station.wire.excitations import Step
from tests.api.conftest import OPERATOR, VIEWER
from tests.client.recorder import Recorder
from tests.two_joint_station import TRAJECTORY, make_station


async def everything(client, station):
    await client.health()
    assert (await client.status()).cycle == 1
    await client.load_controller("spring", "test/Spring", {"joint": "j"})
    assert (await client.switch_controllers(start=["spring"])).started == ["spring"]
    assert [c.name for c in await client.controllers()] == ["spring"]
    assert (await client.controller("spring")).state == "running"
    etag = (await client.gains("spring")).etag
    assert (await client.set_gains("spring", {"k": 2}, etag)).values == {"k": 2.0}
    assert (await client.command("spring", [0.5], epoch=1)).epoch == 1
    station.loop.step()
    assert (await client.last_command("spring")).last == [0.5]
    assert (await client.controller_state("spring")).desired == [0.5]
    assert (await client.joint_states()).name == ["j"]
    assert len(await client.controller_types()) == 1
    assert (await client.loop()).cycles == station.loop.cycle
    assert (await client.reset_loop_statistics()).cycles == 0
    assert (await client.stop("x")).state == "stopped"
    assert (await client.stop_state()).reason == "x"
    assert (await client.release_stop()).state == "released"
    assert (await client.release_stop(arm=True)).state == "armed"
    assert (await client.unload_controller("spring")).name == "spring"
    assert (await client.stream_ticket()).ticket
    with pytest.raises(ApiError, match="not running"):
        await client.ready()


def test_every_method(served, station):
    async def run():
        async with AsyncStationClient(served.url, OPERATOR) as client:
            await everything(client, station)

    asyncio.run(run())


async def every_goal(client, station):
    await client.switch_controllers(start=["arm"])
    goal = await client.submit_goal("arm", {"trajectory": TRAJECTORY})
    assert (await client.goals("arm"))[0].id == goal.id
    assert (await client.goal("arm", goal.id)).status == "pending"
    station.loop.step(3)
    assert (await client.cancel_goal("arm", goal.id)).cancel_requested
    station.loop.step()
    assert (await client.goal("arm", goal.id)).status == "preempted"
    assert (await client.follow_trajectory("arm", TRAJECTORY, epoch=1)).epoch == 1
    station.loop.step()
    later = await client.query_state("arm", station.loop.time + 1.0)
    assert later.position == pytest.approx([0.4, -0.4])


def test_every_method_of_goals():
    station = make_station()

    async def run(url):
        async with AsyncStationClient(url, OPERATOR) as client:
            await every_goal(client, station)

    app = create_app(station, Authenticator(OPERATOR, VIEWER))
    with ApiServer(app, port=0) as server:
        asyncio.run(run(server.url))


def test_nobody_there_is_said_plainly():
    async def run():
        async with AsyncStationClient("http://127.0.0.1:9", timeout=1.0) as client:
            await client.health()

    with pytest.raises(StationUnreachableError, match=r"127\.0\.0\.1:9"):
        asyncio.run(run())


def test_a_client_can_move_to_another_station(served):
    async def run():
        async with AsyncStationClient("http://127.0.0.1:9", "old") as client:
            with pytest.raises(StationUnreachableError):
                await client.session()
            client.talk_to(served.url, VIEWER)
            return (await client.session()).role

    assert asyncio.run(run()) == "viewer"


def test_streams_are_encrypted_for_whoever_trusts_the_station(encrypted, tls):
    async def run():
        ca = str(tls.certificate)
        async with AsyncStationClient(encrypted.url, OPERATOR, ca=ca) as client:
            await client.load_controller("spring", "test/Spring", {"joint": "j"})
            await client.switch_controllers(start=["spring"], idempotency_key="start")
            async with client.stream("joint_states") as stream:
                assert stream.progress.connected
            async with client.command_stream("spring") as commands:
                await commands.send([0.5])

    asyncio.run(run())


BENCH_ARRAYS = ("time", "desired", "position", "velocity", "effort", "output")


def test_the_bench_excites_a_joint_and_answers_with_its_response():
    response = {
        "controller": "a/b",
        "joint": "j",
        "kind": "step",
        "gains": {"p": 1.0},
        **{key: [0.0] for key in BENCH_ARRAYS},
        "metrics": {"overshoot": 0.1},
        "units": {"overshoot": ""},
        "cycles": 1,
        "lost": 0,
    }
    recorder = Recorder(response)
    step = Step(joint="j", amplitude=0.1)

    found = recorder.run(lambda client: client.bench("a/b", step, duration=1.5))

    assert found.metrics == {"overshoot": 0.1}
    ((method, path, body),) = recorder.requests
    assert (method, path) == ("POST", "/api/v1/controllers/a%2Fb/bench")
    assert body["excitation"] == {"kind": "step", "joint": "j", "amplitude": 0.1}
    assert body["duration"] == 1.5
    with pytest.raises(ValueError, match="less than or equal to 10"):
        recorder.run(lambda client: client.bench("a", step, duration=11.0))


class FakeStream(AsyncStream):
    """Batches of ten cycles of 1 ms."""

    batches = 0

    async def __aenter__(self):
        return self

    async def receive(self, timeout=None):
        """Return the next batch."""
        first, self.batches = 10 * self.batches, self.batches + 1
        samples = [
            {"stamp": n / 1000, "position": [n]} for n in range(first, first + 10)
        ]
        data = {"name": ["a"], "samples": samples, "lost": 0}
        return StreamFrame(topic="joint_states", seq=1, epoch=1, stamp=0.0, data=data)


class FakeStation(AsyncStationClient):
    """A station that streams."""

    def stream(self, topic, **options):
        """Return the stream."""
        self.opened = (topic, options)
        self.given = FakeStream(super().stream(topic, **options).options)
        return self.given


def test_every_cycle_of_the_time_is_collected():
    station = FakeStation("http://a", "t")

    samples = asyncio.run(station.collect(0.025))

    np.testing.assert_array_equal(samples["position"][:, 0], np.arange(26))
    assert station.given.batches == 3
    assert station.opened == ("joint_states", {"rate": "full", "reconnect": False})


def test_station_is_shown_with_its_joints(served):
    with StationClient(served.url, OPERATOR) as client:
        html = client._repr_html_()

    assert f"<a href='{served.url}/docs'>" in html
    assert "<td>0.2500</td>" in html
    assert "running: nothing" in html


def test_station_that_does_not_answer_is_told():
    def refuse(request):
        raise httpx.ConnectError("<refused>", request=request)

    html = summary_html("http://a", None, httpx.MockTransport(refuse))

    assert html.endswith("no answer (&lt;refused&gt;)")
