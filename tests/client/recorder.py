"""A station that records the requests of a client and gives one answer to all."""

import asyncio
import json

import httpx

from station.client import AsyncStationClient

URL = "http://127.0.0.1:8000"


class Recorder:
    """Keeps the requests as (method, path with query, JSON body).

    Args:
        answer: The JSON that every request is answered with.
        status: The status of these answers.
    """

    def __init__(self, answer, status=200):
        self.requests = []
        self.headers = []
        self._json = answer
        self._status = status

    def answer(self, request):
        """Keep the request and return the answer."""
        path = request.url.raw_path.decode()
        body = json.loads(request.content) if request.content else None
        self.requests.append((request.method, path, body))
        self.headers.append(request.headers)
        return httpx.Response(self._status, json=self._json)

    def run(self, ask):
        """Return what the coroutine function `ask` returns when given a client."""

        async def run():
            transport = httpx.MockTransport(self.answer)
            async with AsyncStationClient(URL, "t", transport=transport) as client:
                return await ask(client)

        return asyncio.run(run())
