"""The dashboard keeps up with the station, and says when it does not."""

import asyncio

from station.client import ApiError, AsyncStationClient
from station.ui.link import station_link
from station.ui.link.station_link import StationLink
from tests.ui.fake_answers import JOINTS
from tests.ui.fake_station import OPERATOR, START
from tests.waiting import PATIENCE


def _follow(url, script):
    """Run a link beside `script(link)`, a coroutine function."""

    async def run():
        async with AsyncStationClient(url, OPERATOR, timeout=PATIENCE) as client:
            link = StationLink(client)
            running = asyncio.create_task(link.run())
            try:
                await script(link)
            finally:
                running.cancel()
                await asyncio.wait({running})

    asyncio.run(run())


async def _until(holds, seconds=PATIENCE):
    deadline = asyncio.get_running_loop().time() + seconds
    while not holds() and asyncio.get_running_loop().time() < deadline:
        await asyncio.sleep(0.01)
    assert holds()


def test_joints_controllers_types_and_status_arrive(fake_station):
    fake_station.load("arm", running=True)

    async def script(link):
        await _until(lambda: link.view().positions and link.view().elements)
        await _until(lambda: link.view().limits)
        view = link.view()
        assert view.positions == dict(zip(JOINTS, START, strict=True))
        assert [c.name for c in view.controllers] == ["arm"]
        assert len(view.elements["arm"]) == 7
        assert view.status.epoch == 1
        assert view.types
        assert view.limits == dict.fromkeys(JOINTS, (-2.5, 2.5))
        assert view.link == "live"

    _follow(fake_station.url, script)


def test_what_keeps_an_end_effector_from_its_motion_arrives(fake_station):
    fake_station.message = "A singular pose is near; the arm waits there."
    jog = "franka_controllers/CartesianJogController"
    fake_station.load("jog", jog, running=True)
    fake_station.load("arm", running=True)

    async def script(link):
        await _until(lambda: link.view().messages)
        assert link.view().messages == {"jog": fake_station.message}

    _follow(fake_station.url, script)


def test_a_link_that_is_woken_asks_at_once(fake_station, monkeypatch):
    monkeypatch.setattr(station_link, "_CONTROLLERS_PERIOD", 10.0 * PATIENCE)

    async def script(link):
        await _until(lambda: link.view().status)
        fake_station.load("arm", running=True)
        await _until(lambda: link.wake() or link.view().controllers)

    _follow(fake_station.url, script)


def test_a_request_that_went_to_the_former_station_is_repeated_at_once(monkeypatch):
    monkeypatch.setattr(station_link, "_CONTROLLERS_PERIOD", 10.0 * PATIENCE)
    asked = []

    async def script(link):
        answered = asyncio.Event()

        async def controllers():
            asked.append(len(asked))
            if len(asked) == 1:
                # The next station is announced while the former one is still asked.
                link.wake()
                raise ApiError("the token is wrong", status=401, code="unauthorized")
            answered.set()
            return ()

        monkeypatch.setattr(link.client, "controllers", controllers)
        async with asyncio.timeout(PATIENCE):
            await answered.wait()

    _follow("http://127.0.0.1:9", script)
    assert asked == [0, 1]


def test_who_draws_the_robot_is_woken_by_its_positions(fake_station):
    async def script(link):
        async with asyncio.timeout(PATIENCE):
            await link.wait_for_motion(10.0 * PATIENCE)
        assert link.view().positions

    _follow(fake_station.url, script)


def test_who_draws_the_robot_is_woken_in_time_when_nothing_moves():
    async def script(link):
        async with asyncio.timeout(PATIENCE):
            await link.wait_for_motion(0.0)
        assert not link.view().positions

    _follow("http://127.0.0.1:9", script)


def test_watched_controllers_are_sampled_and_others_forgotten(fake_station):
    fake_station.load("arm", running=True)

    async def script(link):
        link.watch({"arm"})
        await _until(lambda: "arm" in link.view().samples)
        assert link.view().samples["arm"].name == JOINTS
        link.watch(set())
        assert link.view().samples == {}

    _follow(fake_station.url, script)


def test_data_ages_while_the_station_is_away_and_its_absence_is_explained():
    async def script(link):
        await _until(lambda: link.view().failure)
        assert "No answer from the station" in link.view().failure
        assert link.view().link == "lost"

    _follow("http://127.0.0.1:9", script)


def test_a_restarted_station_is_looked_at_afresh(fake_station):
    fake_station.load("arm", running=True)

    async def script(link):
        await _until(lambda: link.view().elements)
        fake_station.boot_id = "boot-2"
        fake_station.controllers.clear()
        await _until(lambda: link.view().status.boot_id == "boot-2")
        await _until(lambda: not link.view().elements)

    _follow(fake_station.url, script)
