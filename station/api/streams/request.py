"""Requests for streams: topic, rate, fields, format."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from station.api.streams.topics import Topic, find_topic, topic_names
from station.core.errors import suggest
from station.core.facade.station import Station
from station.events import EventLog
from station.wire import CLOSE_BAD_REQUEST, CLOSE_UNKNOWN_TOPIC, StreamFormat

MIN_RATE = 0.1
MAX_RATE = 500.0
FULL = "full"
_FORMATS: dict[str, StreamFormat] = {"json": "json", "msgpack": "msgpack"}
_PARAMETERS = {"rate", "fields", "format", "ticket"}


class StreamRequestError(Exception):
    """A request for a stream that the station refuses.

    Attributes:
        close_code: Code with which the WebSocket is closed.
        reason: Reason of the refusal, short enough for a close frame (123 bytes).
    """

    def __init__(self, reason: str, close_code: int = CLOSE_BAD_REQUEST) -> None:
        super().__init__(reason)
        self.close_code = close_code
        self.reason = reason.encode()[:120].decode(errors="ignore")


@dataclass(frozen=True, slots=True)
class StreamRequest:
    """A request for a stream. Clients with equal requests get the same frames.

    Attributes:
        topic: Name of the topic.
        rate: Frames per second [Hz]; None for every cycle.
        fields: Keys of the payload to send; empty sends all.
        format: Encoding of the frames.
    """

    topic: str
    rate: float | None
    fields: frozenset[str]
    format: StreamFormat


def parse_request(
    station: Station,
    name: str,
    query: Mapping[str, str],
    log: EventLog | None = None,
) -> tuple[StreamRequest, Topic]:
    """Return the request and its topic.

    Args:
        station: The station.
        name: The topic's name in the URL.
        query: The URL's query.
        log: The station's event log; without one there is no topic `events`.

    Raises:
        StreamRequestError: The topic is unknown, or a parameter is wrong.
    """
    topic = find_topic(station, name, log)
    if topic is None:
        raise StreamRequestError(
            f"No topic '{name:.24}'. {suggest(name, topic_names(station))}",
            CLOSE_UNKNOWN_TOPIC,
        )
    unknown = set(query) - _PARAMETERS
    if unknown:
        raise StreamRequestError(
            f"There is no parameter {min(unknown)!r:.30}. Use rate, fields or format.",
        )
    rate = _rate(topic, query)
    known_fields = topic.sample_fields if rate is None else topic.fields
    request = StreamRequest(
        topic.name, rate, _fields(known_fields, query), read_format(query)
    )
    return request, topic


def _rate(topic: Topic, query: Mapping[str, str]) -> float | None:
    text = query.get("rate")
    if text is None:
        return topic.default_rate
    if text == FULL and not topic.sample_fields:
        return topic.default_rate  # every event is sent, whatever the rate
    if text == FULL:
        return None
    try:
        rate = float(text)
    except ValueError:
        rate = 0.0
    if not MIN_RATE <= rate <= MAX_RATE:
        allowed = f"a number from {MIN_RATE} to {MAX_RATE} [Hz], or full"
        raise StreamRequestError(f"The rate is {text!r:.20}. Give {allowed}.")
    return rate


def _fields(known: Sequence[str], query: Mapping[str, str]) -> frozenset[str]:
    fields = frozenset(query.get("fields", "").split(",")) - {""}
    unknown = fields - set(known)
    if unknown:
        raise StreamRequestError(
            f"No field {min(unknown)!r:.24}. {suggest(min(unknown), known)}",
        )
    return fields


def read_format(query: Mapping[str, str]) -> StreamFormat:
    """Return the format of the messages.

    Raises:
        StreamRequestError: The format is unknown.
    """
    chosen = _FORMATS.get(query.get("format", "json"))
    if chosen is None:
        raise StreamRequestError(
            f"The format is {query['format']!r:.20}. Give json or msgpack.",
        )
    return chosen
