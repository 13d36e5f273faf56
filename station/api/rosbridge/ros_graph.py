"""The graph of a station: its topics, services and actions by name."""

from collections import ChainMap
from collections.abc import Callable, Mapping
from typing import Any

from station.api.rosbridge.actions import Action, StationActions
from station.api.rosbridge.broker import Broker, Offer
from station.api.rosbridge.ros_types import RosTypeError, split_style
from station.api.rosbridge.rosapi import Rosapi
from station.api.rosbridge.services import RosService, StationServices
from station.api.rosbridge.tf_republisher import TfRepublisher
from station.api.rosbridge.topics import StationTopics, Topic
from station.api.services import Services
from station.core.description.urdf import Urdf
from station.core.errors import suggest
from station.records.cdr import Values


class RosGraph:
    """The present topics, services and actions. Use it in one event loop only.

    Args:
        services: The services of the API.
        urdf: The robot, for transforms; None sends no transforms.
        texts: Text by topic, such as `/robot_description`.
        publish: Publishes a message: topic, type, message.

    Attributes:
        station: The station.
        broker: Topics, services and actions that clients offer to each other.
        topics: All topics by name; the station's topics hide those of clients.
        services: All services by name, in the same way.
        actions: All actions by name, in the same way.
        clock: The station's topics, which make the messages of cycles and know their
            time.
        goals: Follows the goals of clients.
    """

    def __init__(
        self,
        services: Services,
        urdf: Urdf | None,
        texts: Mapping[str, str],
        publish: Callable[[str, str, Values], None],
    ) -> None:
        self.station = station = services.station
        self.broker = Broker(publish)
        topics: Any = self.broker.topics
        offers: dict[str, Any] = self.broker.offers
        self.topics = ChainMap[str, Topic]({}, topics)
        self.services = ChainMap[str, RosService | Offer]({}, offers["services"])
        self.actions = ChainMap[str, Action | Offer]({}, offers["actions"])
        self.clock = StationTopics(services, urdf, texts)
        self.goals = StationActions(station, self.clock, publish)
        self._services = StationServices(station, self.clock)
        self._rosapi = Rosapi(self)
        self._republishers: list[TfRepublisher] = []
        if urdf is not None:
            self._republishers = [TfRepublisher(urdf, self.clock, self._add)]
        self._known: list[tuple[str, str]] = []

    def _add(self, topic: Topic) -> None:
        self.topics.maps[0][topic.name] = topic

    def _loaded(self) -> list[tuple[str, str]]:
        conditions = self.station.manager.conditions()
        return [(one.name, one.type) for one in conditions]

    def refresh(self) -> None:
        """Update topics, services and actions to the loaded controllers."""
        self._known = self._loaded()
        actions, own = list(self.goals.all()), self.topics.maps[0]
        topics = list(self.clock.all())
        services = [*self._services.all(), *self._rosapi.all()]
        for one in self._republishers:
            actions.append(one.action)
            services.append(one.service)
            topics += one.topics()
        self.actions.maps[0] = {one.name: one for one in actions}
        for action in actions:
            topics += self.goals.topics_of(action)
        # Keep the object of a topic that stays, with the time and content of its last
        # message.
        self.topics.maps[0] = {
            one.name: old
            if (old := own.get(one.name)) is not None and old.type == one.type
            else one
            for one in topics
        }
        self.services.maps[0] = {one.name: one for one in services}
        names = [*self.topics.maps[0], *self.services.maps[0], *self.actions.maps[0]]
        names += [name for name, _ in self._known]
        root = self.station.parameter_server.get()
        names += root if isinstance(root, dict) else ()
        self.broker.reserve(frozenset(n.strip("/").partition("/")[0] for n in names))

    def find(self, what: str, name: str, type_name: str = "") -> Any:  # noqa: ANN401 - of the kind of `what`
        """Return a topic, a service or an action.

        Args:
            what: topics, services or actions.
            name: Its name.
            type_name: Its type in either style; empty accepts any type.

        Raises:
            RosTypeError: The name is unknown, or it has another type.
        """
        name, known = path_of(name), getattr(self, what)
        # A refresh costs a millisecond, and clients may ask often, so refresh only
        # after a change.
        if name not in known.maps[0] and self._known != self._loaded():
            self.refresh()
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


def path_of(name: object) -> str:
    """Return a name with a leading slash, which roslibjs omits: `rosapi/topics`."""
    return f"/{str(name).strip('/')}"
