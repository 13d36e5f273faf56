"""Queue the messages to one client, which may read slowly or not at all."""

import asyncio
from collections import deque
from dataclasses import dataclass, field

from station.api.rosbridge.publication import Form, Publication, text_frames
from station.api.streams.stream_client import StreamPort
from station.records.cdr import Values

MOST_ANSWERS = 1000
"""Most waiting answers for a client that does not read."""
MOST_BYTES = 8_000_000
"""Most bytes in all queues of a client together; enough for pictures of a few seconds.
"""
LEVELS = ("none", "error", "warning", "info")
"""Levels of statuses; each level includes those before it."""


@dataclass(slots=True)
class Subscription:
    """A client's subscriptions to one topic.

    Attributes:
        wishes: Throttle rate [s], queue length and form of each subscription, by its
            identifier.
        queue: Waiting messages, the oldest first.
        due: When the next message may be sent [s, clock of the event loop].
        size: Size of the waiting messages as JSON [bytes].
        lost: Number of messages that the client has lost because it did not read.
        throttle: Shortest throttle rate of the subscriptions [s].
        length: Length of the longest queue of the subscriptions.
        form: The form that was requested last.
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
        """Combine the wishes of all subscriptions into throttle, length and form."""
        throttles, lengths, forms = zip(*self.wishes.values(), strict=True)
        self.throttle, self.length = min(throttles), max(lengths)
        self.form = forms[-1]

    def push(self, publication: Publication) -> None:
        """Add a message to the queue."""
        self.queue.append(publication)
        self.size += publication.size

    def pop(self) -> Publication:
        """Remove the oldest message from the queue, and return it."""
        publication = self.queue.popleft()
        self.size -= publication.size
        return publication


class Outbox:
    """Sends answers at once, and messages of topics when they are due.

    A client that does not read loses the oldest messages of each topic, and is told
    their number; other clients do not wait for it. Use it in one event loop only.

    Args:
        port: The connection.
        half_tick: Half the time between two ticks [s], by which a message may be early.

    Attributes:
        subscriptions: Subscriptions of the client, by topic.
        level: The level of `LEVELS` up to which the client wants statuses.
        overflown: Event that is set when too many answers wait.
    """

    def __init__(self, port: StreamPort, half_tick: float) -> None:
        self.subscriptions: dict[str, Subscription] = {}
        self.level = "warning"
        self.overflown = asyncio.Event()
        self._port = port
        self._half_tick = half_tick
        self._answers: deque[bytes] = deque()

    def offer(self, publication: Publication, now: float) -> None:
        """Send or queue a message of a subscribed topic.

        Args:
            publication: The message.
            now: Clock of the event loop [s].
        """
        one = self.subscriptions[publication.topic]
        is_free = self._can_write()
        # Without a queue, the client wants messages that come too early to be left out.
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
        """Send the queued messages that are due, if the client reads.

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
            identifier: Identifier of the client's message; None without one.
        """
        if LEVELS.index(level) <= LEVELS.index(self.level):
            self.answer({"op": "status", "level": level, "msg": text[:500]}, identifier)

    def answer(
        self, message: Values, identifier: object = None, form: Form | None = None
    ) -> None:
        """Send an answer, or keep it until the client reads.

        Args:
            message: The answer.
            identifier: Identifier of the client's message; None without one.
            form: Form of the answer; None for plain JSON.
        """
        if identifier is not None:
            message["id"] = identifier
        self._answers.append(text_frames(message, form or Form()))
        self._send_answers()
        if len(self._answers) > MOST_ANSWERS:
            self.overflown.set()

    def resume(self) -> None:
        """Send waiting messages to a client that reads again."""
        self._send_answers()
        self.flush(asyncio.get_running_loop().time())

    def _send_answers(self) -> None:
        while self._answers and self._port.is_writable():
            self._port.write_frame(self._answers.popleft())

    def _can_write(self) -> bool:
        return not self._answers and self._port.is_writable()

    def _limit_bytes(self) -> None:
        """Drop the oldest messages of the largest queue, until all queues fit."""
        found = self.subscriptions.values()
        while sum(one.size for one in found) > MOST_BYTES:
            # Shorten the largest queue, so that pictures do not displace small messages
            # of states.
            largest = max(found, key=lambda one: one.size)
            largest.pop()
            largest.lost += 1

    def _flush(self, one: Subscription, now: float) -> None:
        while one.queue and now + self._half_tick >= one.due and self._can_write():
            # Keep a steady rate: a late message must not delay the next one.
            is_steady = now - one.due < one.throttle
            one.due = (one.due if is_steady else now) + one.throttle
            self._port.write_frame(one.pop().frames(one.form))
