"""The tool port for clients of rosbridge."""

import asyncio
from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from fastapi import FastAPI
from typing_extensions import override

from station.api.rosbridge.outbox import Publication
from station.api.rosbridge.ros_graph import RosGraph
from station.api.rosbridge.session import RosbridgeSession
from station.api.rosbridge.topics import LATCHED
from station.api.tool_port import Place, ToolClient, ToolPort
from station.core.description.urdf import Urdf
from station.records.cdr import Values

if TYPE_CHECKING:
    from station.api.services import Services

_REFRESH_EVERY = 50
"""Ticks between two checks whether controllers were loaded or unloaded."""


class RosbridgePort(ToolPort[RosbridgeSession]):
    """The application at the tool port that speaks the rosbridge protocol.

    Args:
        app: The application of the API, whose station, tokens and lease it shares.
        urdf: The robot, for transforms; None sends no transforms.
        texts: Text by topic, such as `/robot_description`.
        place: Address of the port, and the clients that it admits.
    """

    tool: ClassVar[str] = "rosbridge"
    rate: ClassVar[float] = 100.0
    most_clients: ClassVar[int] = 32

    def __init__(
        self,
        app: FastAPI,
        urdf: Urdf | None,
        texts: Mapping[str, str],
        place: Place,
    ) -> None:
        super().__init__(app, place)
        services: Services = app.state.services
        self._graph = RosGraph(services, urdf, texts, self._publish)
        self._ticks = 0
        self._cycle = 0

    @override
    def open(self, client: ToolClient) -> RosbridgeSession:
        self._graph.refresh()
        return RosbridgeSession(client, self._graph, 0.5 / self.rate)

    @override
    async def tick(self) -> None:
        self._ticks += 1
        if self._ticks % _REFRESH_EVERY == 0:
            self._graph.refresh()
        frame = self._graph.clock.frame()
        now = asyncio.get_running_loop().time()
        if frame is None:
            return
        is_new, self._cycle = frame.snapshot.cycle != self._cycle, frame.snapshot.cycle
        for name in {
            name for one in self.sessions for name in one.outbox.subscriptions
        }:
            topic = self._graph.topics.get(name)
            if topic is None or topic.read is None or topic.period == LATCHED:
                continue
            if not (is_new or topic.in_pause) or now + 0.5 / self.rate < topic.due:
                continue
            self._graph.station.loop.cycle_yield.wait_if_cycle_is_due()
            message = topic.read(frame)
            if message is not None:
                topic.due = now + topic.period
                self._deliver(Publication(name, topic.type, message, frame.stamp), now)
        for session in self.sessions:
            session.outbox.flush(now)

    def _publish(self, topic: str, type_name: str, message: Values) -> None:
        stamp = self._graph.clock.now()
        now = asyncio.get_running_loop().time()
        self._deliver(Publication(topic, type_name, message, stamp), now)

    def _deliver(self, publication: Publication, now: float) -> None:
        for session in self.sessions:
            if publication.topic in session.outbox.subscriptions:
                session.outbox.offer(publication, now)
