"""The asynchronous client of an arm has what the synchronous one has."""

import asyncio
import inspect

from station.client.async_robot_client import AsyncRobotClient
from station.client.robot_client import RobotClient


def test_both_clients_have_the_same_methods():
    def signatures(client):
        members = inspect.getmembers(client, inspect.isfunction)
        return {n: str(inspect.signature(m)) for n, m in members if n[0] != "_"}

    assert signatures(AsyncRobotClient) == signatures(RobotClient)


def test_answers_are_awaited():
    async def answer(call):
        return call.path

    path = asyncio.run(AsyncRobotClient(answer, "panda").state())

    assert path == "/api/v1/robots/panda/state"
