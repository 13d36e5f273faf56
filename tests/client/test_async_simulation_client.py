"""The asynchronous client of a simulation has what the synchronous one has."""

import asyncio
import inspect

from station.client.async_simulation_client import AsyncSimulationClient
from station.client.simulation_client import SimulationClient


def test_both_clients_have_the_same_methods():
    def signatures(client):
        members = inspect.getmembers(client, inspect.isfunction)
        return {n: str(inspect.signature(m)) for n, m in members if n[0] != "_"}

    assert signatures(AsyncSimulationClient) == signatures(SimulationClient)


def test_answers_are_awaited():
    async def answer(call):
        return call.path

    path = asyncio.run(AsyncSimulationClient(answer).state())

    assert path == "/api/v1/simulation"
