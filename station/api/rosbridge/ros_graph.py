"""The graph of a station: its topics, services and actions by name."""

from collections.abc import Callable, Mapping
from typing import Any

from station.api.rosbridge.actions import Action, StationActions
from station.api.rosbridge.ros_types import RosTypeError, split_style
from station.api.rosbridge.rosapi import Rosapi
from station.api.rosbridge.services import RosService, StationServices
from station.api.rosbridge.topics import StationTopics, Topic
from station.core.description.urdf import Urdf
from station.core.errors import suggest
from station.core.facade.station import Station
from station.records.cdr import Values


class RosGraph:
    """Topics, services and actions there are at the moment. For one event loop.

    Args:
        station: The station.
        urdf: The robot for transforms; None sends none.
        texts: Text by topic, such as `/robot_description`.
        publish: Publishes a message: topic, type, message.

    Attributes:
        station: The station.
        topics: The topics by name.
        services: The services by name.
        actions: The actions by name.
        clock: Makes the messages of cycles, and knows their time.
        goals: Follows the goals of clients.
    """

    def __init__(
        self,
        station: Station,
        urdf: Urdf | None,
        texts: Mapping[str, str],
        publish: Callable[[str, str, Values], None],
    ) -> None:
        self.station = station
        self.topics: dict[str, Topic] = {}
        self.services: dict[str, RosService] = {}
        self.actions: dict[str, Action] = {}
        self.clock = StationTopics(station, urdf, texts)
        self.goals = StationActions(station, self.clock, publish)
        self._services = StationServices(station, self.clock)
        self._rosapi = Rosapi(self)
        self._known: list[tuple[str, str]] = []

    def _loaded(self) -> list[tuple[str, str]]:
        conditions = self.station.manager.conditions()
        return [(one.name, one.type) for one in conditions]

    def refresh(self) -> None:
        """Look which controllers are loaded."""
        self._known = self._loaded()
        self.actions = {one.name: one for one in self.goals.all()}
        topics = {one.name: one for one in self.clock.all()}
        for action in self.actions.values():
            topics |= {one.name: one for one in self.goals.topics_of(action)}
        # A topic that stays keeps its time, and what it has sent last.
        self.topics = {
            name: self.topics[name]
            if name in self.topics and self.topics[name].type == topic.type
            else topic
            for name, topic in topics.items()
        }
        services = (*self._services.all(), *self._rosapi.all())
        self.services = {one.name: one for one in services}

    def find(self, what: str, name: str, type_name: str = "") -> Any:  # noqa: ANN401 - of the kind of `what`
        """Return a topic, a service or an action.

        Args:
            what: topics, services or actions.
            name: Its name.
            type_name: Its type in either style; any when empty.

        Raises:
            RosTypeError: There is none of that name, or it has another type.
        """
        name = f"/{name.strip('/')}"  # roslibjs asks for `rosapi/topics`
        # Looking anew costs a millisecond, and a client may ask for anything.
        if name not in getattr(self, what) and self._known != self._loaded():
            self.refresh()
        known = getattr(self, what)
        if name not in known:
            raise RosTypeError(
                f"There is no {what[:-1]} '{name:.80}'.", remedy=suggest(name, known)
            )
        found = known[name]
        if type_name and split_style(type_name)[0] != found.type:
            raise RosTypeError(
                f"'{name}' has the type {found.type}, not {type_name:.80}."
            )
        return found
