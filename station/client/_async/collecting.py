"""Collect what a topic streams for some seconds."""

from typing import TYPE_CHECKING

from station.client.samples import Samples
from station.client.stream_options import Rate

if TYPE_CHECKING:
    from station.client._async.station_client import AsyncStationClient


async def collect(
    client: "AsyncStationClient", seconds: float, topic: str, rate: Rate
) -> Samples:
    """Return the samples of a topic; see `AsyncStationClient.collect`.

    Args:
        client: The station.
        seconds: How much station time, > 0 [s].
        topic: What is streamed.
        rate: Samples per second [Hz], or "full" for every cycle.

    Raises:
        ApiError: The station refuses the stream.
        StreamTimeoutError: Nothing comes, e.g. because the simulation is paused.
    """
    samples = Samples(topic)
    wait = client.timeout
    async with client.stream(topic, rate=rate, reconnect=False) as stream:
        while samples.duration < seconds:
            samples.add(await stream.wait_for(lambda _: True, wait))
    samples.cut(seconds)
    return samples
