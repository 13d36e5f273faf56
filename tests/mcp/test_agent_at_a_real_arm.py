"""An agent asks a real arm to move: rehearsal, leave and envelope hold there, too.

The arm is the simulated one behind the Franka Control Interface; the station knows it
by its protocol alone, and rehearses on a model of it.
"""

import asyncio

import httpx
import pytest

from station.api.agents import AgentPolicy
from station.api.app import create_app
from station.core.loop.stop_latch import StopState
from station.rehearsal.envelope import Envelope
from station.rehearsal.rehearsals import Rules, Tolerances
from tests.api.conftest import OPERATOR, URL
from tests.app.test_twin import RealArm
from tests.rehearsal.test_rehearsals import POSITION, goal, moved

GOALS = f"/api/v1/controllers/{POSITION}/goals"
NEAR, FAR = moved(j1=0.3, j4=-0.1), moved(j1=0.8, j4=-0.1)
BOUNDS = Envelope(joints={"panda_joint1": (-0.5, 0.5)}, speed=1.0)
TUBE = 0.0015


class Seat:
    """An agent that holds control of a station with a real arm, and a person."""

    def __init__(self, real, authenticator):
        self.real = real
        policy = AgentPolicy(wait=60.0)
        self.app = create_app(real.facade, authenticator, agents=policy)
        self.services = self.app.state.services
        rules = Rules(envelope=BOUNDS, tolerances=Tolerances(0.01, TUBE))
        # Without a process of its own, which takes a second.
        self.services.rehearsals.adopt(rules, real.run_here)
        self.person = self._client(OPERATOR)

    def _client(self, token):
        return httpx.AsyncClient(
            transport=httpx.ASGITransport(self.app),
            base_url=URL,
            headers={"Authorization": f"Bearer {token}"},
            timeout=60.0,
        )

    async def sit_down(self):
        secret = await self.services.authenticator.named.create("tuner", "agent", None)
        self.agent = self._client(secret)
        taken = await self.agent.post("/api/v1/control", json={"ttl": 300})
        assert taken.is_success

    async def rehearse(self, target, duration=2.0):
        steps = goal(POSITION, target, duration)
        body = {"steps": steps, "certificate": True}
        report = (await self.agent.post("/api/v1/rehearse", json=body)).json()
        return report, {"goal": steps[0]["request"]}

    async def ask(self, report, request, verdict):
        """Give a goal with its certificate, and answer as the person."""
        url = f"{GOALS}?certificate={report['certificate']['name']}"
        asked = asyncio.create_task(self.agent.post(url, json=request))
        while not (waiting := self._waiting()):
            await asyncio.sleep(0.01)
        assert not self.real.facade.motion.goals(POSITION)
        path = f"/api/v1/agents/requests/{waiting[0].number}"
        assert (await self.person.post(path, json={"verdict": verdict})).is_success
        return await asked

    def _waiting(self):
        return [one for one in self.services.agents.requests() if one.verdict is None]


@pytest.fixture
def seat(monkeypatch, tmp_path, authenticator):
    real = RealArm(monkeypatch, tmp_path)
    yield Seat(real, authenticator)
    real.facade.loop.hw.close()


def test_an_agent_moves_a_real_arm_as_rehearsed_and_allowed_and_no_other_way(seat):
    real = seat.real
    before = real.arm.state.q

    async def story():
        await seat.sit_down()
        outside, far = await seat.rehearse(FAR)
        assert (outside["outcome"], outside["twin"]) == ("failed", "model")
        assert outside["error"]["code"] == "outside_envelope"
        assert outside["certificate"] is None
        assert (await seat.agent.post(GOALS, json=far)).status_code == 428

        report, near = await seat.rehearse(NEAR)
        refused = await seat.ask(report, near, "refused")
        assert refused.json()["code"] == "agent_refused"
        real.step(200)
        assert real.arm.state.q == pytest.approx(before, abs=1e-6)

        assert (await seat.ask(report, near, "allowed")).status_code == 201

    asyncio.run(story())
    real.step(2500)
    assert real.arm.state.q == pytest.approx(NEAR, abs=2e-3)
    assert real.facade.status().stop_reason == ""


def test_a_real_arm_that_leaves_what_an_agent_rehearsed_is_stopped(seat):
    real = seat.real

    async def story():
        await seat.sit_down()
        report, near = await seat.rehearse(NEAR)
        assert (await seat.ask(report, near, "allowed")).status_code == 201

    asyncio.run(story())
    real.step(500)
    assert real.facade.status().stop_state is StopState.ARMED
    real.arm.simulation().apply_force("panda_hand", [0, 40.0, 0], [0, 0, 0], 0.5)
    real.step(500)
    status = real.facade.status()
    assert status.stop_state is StopState.STOPPED
    assert "panda_joint" in status.stop_reason
    assert real.arm.state.q != pytest.approx(NEAR, abs=2e-3)
