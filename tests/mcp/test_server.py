"""The seat of agents, by the protocol's own client, at an app without a net."""

import asyncio
import json

import httpx
import pytest
from mcp import Client, MCPError

from station.api.agents import AgentPolicy
from station.api.app import create_app
from station.api.auth import Authenticator
from station.client.connection import AsyncConnection
from station.mcp.server import AgentServer
from tests.api.conftest import URL
from tests.api.spring import make_station


@pytest.fixture(scope="module")
def document():
    """Return the description of the API, which takes half a second to make."""
    return create_app(make_station(), Authenticator()).openapi()


@pytest.fixture
def run(authenticator, document, tmp_path):
    """Return what runs a story with a client of the protocol."""
    page = tmp_path / "safety.md"
    page.write_text("# Safety\n", encoding="utf-8")

    async def told(story, *, is_asked):
        station = make_station()
        station.loop.step()
        station.load_controller("spring", "test/Spring", {"joint": "j", "k": 2.0})
        policy = AgentPolicy(approval=is_asked, wait=0.02)
        app = create_app(station, authenticator, agents=policy)
        secret = await authenticator.named.create("tuner", "agent", None)
        connection = AsyncConnection(URL, secret, 10.0, httpx.ASGITransport(app))
        seat = AgentServer(connection, document, tmp_path, tmp_path / "journal.jsonl")
        async with Client(seat.server) as agent:
            await story(agent, station)
        await connection.close()

    def run(story, *, is_asked=False):
        asyncio.run(told(story, is_asked=is_asked))

    return run


def told(result):
    """Return the text of an answer."""
    return result.content[0].text


def test_tools_are_the_operations_that_the_api_offers(run):
    async def story(agent, _):
        tools = {tool.name: tool for tool in (await agent.list_tools()).tools}
        assert {"status", "stop", "submit_goal", "explain_last_refusal"} <= tools.keys()
        assert not {"create_token", "list_tokens", "release_stop"} & tools.keys()
        assert tools["status"].annotations.read_only_hint
        assert tools["grasp"].annotations.destructive_hint
        gains = tools["patch_gains"].input_schema
        assert gains["required"] == ["name", "body"]
        assert gains["properties"]["body"] == {"$ref": "#/$defs/GainsPatch"}
        assert "values" in gains["$defs"]["GainsPatch"]["properties"]
        text = json.dumps([tool.input_schema for tool in tools.values()])
        assert "#/components" not in text

    run(story)


def test_a_call_is_carried_out_and_is_in_the_journal(run, tmp_path):
    call = {"name": "spring", "body": {"values": {"k": 3.0}}}

    async def story(agent, station):
        answer = await agent.call_tool("patch_gains", call)
        assert not answer.is_error, told(answer)
        assert json.loads(told(answer))["values"]["k"] == 3.0
        assert station.tuning.gains("spring").values["k"] == 3.0
        read = json.loads(told(await agent.call_tool("get_gains", {"name": "spring"})))
        assert read["values"]["k"] == 3.0
        control = json.loads(told(await agent.call_tool("get_control", {})))
        assert control["owner"] == "tuner"

    run(story)
    lines = (tmp_path / "journal.jsonl").read_text(encoding="utf-8").splitlines()
    assert json.loads(lines[0]) == {"tool": "patch_gains", "arguments": call}
    assert len(lines) == 3


def test_a_refusal_is_an_answer_that_explains_itself(run):
    call = {"name": "spring", "body": {"values": {"k": 3.0}}}

    async def story(agent, station):
        answer = await agent.call_tool("patch_gains", call)
        assert answer.is_error
        assert "agent_refused" in told(answer)
        assert "Nobody answered within 0.02 s" in told(answer)
        assert station.tuning.gains("spring").values["k"] == 2.0
        why = await agent.call_tool("explain_last_refusal", {})
        assert "Nobody answered within 0.02 s" in told(why)

    run(story, is_asked=True)


@pytest.mark.parametrize(
    ("tool", "arguments", "reason"),
    [
        ("create_token", {}, "There is no tool 'create_token'"),
        ("get_gains", {}, "it needs 'name'; given is nothing"),
        ("get_gains", {"name": "spring", "x": 1}, "given is 'name', 'x'"),
        ("get_gains", {"name": "spring", "body": {}}, "get_gains takes 'name';"),
        ("get_gains", {"name": "nose"}, "`list_controllers` lists the loaded ones"),
        ("get_status", {}, "Did you mean 'status'?"),
        ("get_gains", {"name": "../tokens"}, "No controller '../tokens' is loaded"),
        ("patch_gains", {"name": "spring", "body": 3}, "is an object"),
        ("patch_gains", {"name": "spring", "body": {"values": {"k": 11}}}, "10"),
    ],
)
def test_wrong_calls_are_refused(run, tool, arguments, reason):
    async def story(agent, station):
        answer = await agent.call_tool(tool, arguments)
        assert answer.is_error
        assert reason in told(answer)
        why = await agent.call_tool("explain_last_refusal", {})
        assert reason in told(why)
        assert station.tuning.gains("spring").values["k"] == 2.0

    run(story)


def test_resources_and_prompts(run):
    async def story(agent, _):
        found = [str(r.uri) for r in (await agent.list_resources()).resources]
        assert found == [
            "station://robot",
            "station://events",
            "station://docs/safety.md",
        ]
        page = await agent.read_resource("station://docs/safety.md")
        assert page.contents[0].text == "# Safety\n"
        robot = await agent.read_resource("station://robot")
        assert "EffortJointInterface" in robot.contents[0].text
        with pytest.raises(MCPError, match="no resource"):
            await agent.read_resource("station://docs/../../etc/passwd")
        with pytest.raises(MCPError, match="needs a 'subject'"):
            await agent.get_prompt("tune", {})
        prompt = await agent.get_prompt("tune", {"subject": "spring"})
        assert "controller spring" in prompt.messages[0].content.text

    run(story)
