"""The asynchronous client of a gripper has what the synchronous one has."""

import asyncio
import inspect

from station.client.async_gripper_client import AsyncGripperClient
from station.client.async_robot_client import AsyncRobotClient
from station.client.gripper_client import GripperClient


def test_both_clients_have_the_same_methods():
    def signatures(client):
        members = inspect.getmembers(client, inspect.isfunction)
        return {n: str(inspect.signature(m)) for n, m in members if n[0] != "_"}

    assert signatures(AsyncGripperClient) == signatures(GripperClient)


def test_answers_are_awaited():
    async def answer(call):
        return call.path

    path = asyncio.run(AsyncRobotClient(answer, "panda").gripper.state())

    assert path == "/api/v1/robots/panda/gripper"
