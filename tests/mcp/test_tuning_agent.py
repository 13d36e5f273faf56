"""The example of an agent that tunes: it finds better gains, within its envelope."""

import asyncio
import runpy
from pathlib import Path

import httpx
import pytest
from mcp import Client

from station.api.agents import AgentPolicy
from station.api.app import create_app
from station.client.connection import AsyncConnection
from station.mcp.server import AgentServer
from station.rehearsal.envelope import Envelope
from station.rehearsal.rehearsals import Rules
from tests.api.conftest import URL
from tests.franka_station import JOINTS, make_franka_station

EXAMPLE = Path(__file__).parents[2] / "examples/tune_as_an_agent.py"
NAME = "effort_group_position_controller"
SPEED = 0.8
"""Of the envelope [rad/s]; without one the agent ends at 0.6."""
SOFT = {"p": 300.0, "i": 0.0, "d": 40.0}


@pytest.mark.slow
def test_an_agent_finds_better_gains_within_its_envelope_on_a_stepped_station(
    authenticator,
):
    station = make_franka_station(realism="typical")
    joint_gains = dict.fromkeys(JOINTS, SOFT)
    group = "effort_controllers/JointGroupPositionController"
    station.load_controller(NAME, group, {"joints": JOINTS, "gains": joint_gains})
    tune = runpy.run_path(str(EXAMPLE))["tune"]

    async def tuned():
        policy = AgentPolicy(approval=False)
        app = create_app(station, authenticator, agents=policy)
        app.state.services.rehearsals.adopt(Rules(envelope=Envelope(speed=SPEED)))
        secret = await authenticator.named.create("tuner", "agent", None)
        connection = AsyncConnection(URL, secret, 10.0, httpx.ASGITransport(app))
        seat = AgentServer(connection, app.openapi())
        async with Client(seat.server) as agent:
            found = await tune(agent)
        await connection.close()
        return *found, app.state.services.rehearsals

    first, least, gains, rehearsals = asyncio.run(tuned())

    assert least < 0.6 * first
    values = station.tuning.gains(NAME).values
    assert {name: values[name] for name in gains} == gains
    here = rehearsals.rehearse([], 0.01).positions[-1]
    target = [here[0] + 0.1, *here[1:7]]
    step = {
        "kind": "set_point",
        "name": NAME,
        "values": target,
        "at": 0.0,
        "timeout": None,
        "rates": None,
    }
    told = rehearsals.rehearse([step], 1.5)
    assert 0.5 * SPEED < max(joint.velocity for joint in told.joints) <= SPEED
