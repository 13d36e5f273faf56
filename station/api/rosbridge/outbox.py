"""Queue the messages to one client, which may read slowly or not at all."""

import asyncio
from collections import deque
from dataclasses import dataclass, field

from station.api.rosbridge.publication import Form, Publication, text_frames
from station.api.streams.stream_client import StreamPort
from station.records.cdr import Values

MOST_ANSWERS = 1000
"""Most answers that wait for a client that does not read."""
MOST_BYTES = 8_000_000
"""Most bytes in all queues of a client together: pictures for some seconds."""
LEVELS = ("none", "error", "warning", "info")
"""Levels of statuses, each with those before it."""


@dataclass(slots=True)
class Subscription:
    """A client's subscriptions to one topic.

    Attributes:
        wishes: Throttle rate [s], queue length and form, by the client's identifier.
        queue: Messages that wait, the oldest first.
        due: When the next message may be sent [s, clock of the event loop].
        size: Bytes of the messages that wait, as JSON.
        lost: How many messages the client has lost because it did not read.
        throttle: The lowest throttle rate [s].
        length: The longest queue.
        form: The form that was asked for last.
    """

    wishes: dict[str, tuple[float, int, Form]] = field(default_factory=dict)
    queue: deque[Publication] = field(default_factory=deque)
    size: int = 0
    due: float = 0.0
    lost: int = 0
    throttle: float = 0.0
    length: int = 0
    form: Form = field(default_factory=Form)

    def settle(self) -> None:
        """Combine the wishes of all subscriptions."""
        throttles, lengths, forms = zip(*self.wishes.values(), strict=True)
        self.throttle, self.length = min(throttles), max(lengths)
        self.form = forms[-1]

    def push(self, publication: Publication) -> None:
        """Let a message wait."""
        self.queue.append(publication)
        self.size += publication.size

    def pop(self) -> Publication:
        """Return the oldest message, which waits no longer."""
        publication = self.queue.popleft()
        self.size -= publication.size
        return publication


class Outbox:
    """Sends answers at once and messages of topics at their time. For one event loop.

    A client that does not read loses the oldest messages of each topic and learns how
    many; no other client waits for it.

    Args:
        port: The connection.
        half_tick: Half the time between two ticks [s]: so early a message may be.

    Attributes:
        subscriptions: Subscriptions of the client, by topic.
        level: The last of `LEVELS` whose messages the client wants.
        overflown: Set when too many answers wait.
    """

    def __init__(self, port: StreamPort, half_tick: float) -> None:
        self.subscriptions: dict[str, Subscription] = {}
        self.level = "warning"
        self.overflown = asyncio.Event()
        self._port = port
        self._half_tick = half_tick
        self._answers: deque[bytes] = deque()

    def offer(self, publication: Publication, now: float) -> None:
        """Take a message of a topic that the client has subscribed to.

        Args:
            publication: The message.
            now: Clock of the event loop [s].
        """
        one = self.subscriptions[publication.topic]
        is_free = self._can_write()
        # Without a queue, a message that comes too early is left out, as asked for.
        if is_free and not one.length and now + self._half_tick < one.due:
            return
        one.push(publication)
        while len(one.queue) > max(one.length, 1):
            one.pop()
            one.lost += not is_free
        self._flush(one, now)
        if one.queue:
            self._limit_bytes()

    def flush(self, now: float) -> None:
        """Send the messages that waited for their time or for the client.

        Args:
            now: Clock of the event loop [s].
        """
        for topic, one in self.subscriptions.items():
            if one.queue:
                self._flush(one, now)
            if one.lost and self._can_write():
                text = f"{one.lost} messages of {topic} were lost"
                self.tell("warning", f"{text}: the client reads too slowly.")
                one.lost = 0

    def tell(self, level: str, text: str, identifier: object = None) -> None:
        """Send a status, unless the client does not want its level.

        Args:
            level: One of `LEVELS`.
            text: The event, as a sentence.
            identifier: Of the client's message; None without one.
        """
        if LEVELS.index(level) <= LEVELS.index(self.level):
            self.answer({"op": "status", "level": level, "msg": text[:500]}, identifier)

    def answer(
        self, message: Values, identifier: object = None, form: Form | None = None
    ) -> None:
        """Send an answer, or keep it until the client reads.

        Args:
            message: The answer.
            identifier: Of the client's message; None without one.
            form: Its form.
        """
        if identifier is not None:
            message["id"] = identifier
        self._answers.append(text_frames(message, form or Form()))
        self._send_answers()
        if len(self._answers) > MOST_ANSWERS:
            self.overflown.set()

    def resume(self) -> None:
        """Go on with a client that reads again."""
        self._send_answers()
        self.flush(asyncio.get_running_loop().time())

    def _send_answers(self) -> None:
        while self._answers and self._port.is_writable():
            self._port.write_frame(self._answers.popleft())

    def _can_write(self) -> bool:
        return not self._answers and self._port.is_writable()

    def _limit_bytes(self) -> None:
        """Drop the oldest messages of the topic that has most, until all fit."""
        found = self.subscriptions.values()
        while sum(one.size for one in found) > MOST_BYTES:
            # Pictures must not push the states out, which are small.
            largest = max(found, key=lambda one: one.size)
            largest.pop()
            largest.lost += 1

    def _flush(self, one: Subscription, now: float) -> None:
        while one.queue and now + self._half_tick >= one.due and self._can_write():
            # A steady rate: a message that was late does not delay the next one.
            is_steady = now - one.due < one.throttle
            one.due = (one.due if is_steady else now) + one.throttle
            self._port.write_frame(one.pop().frames(one.form))
