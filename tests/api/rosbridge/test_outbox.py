"""What a client loses that does not read, and what it is told."""

import json

import pytest

from station.api.rosbridge.outbox import (
    MOST_ANSWERS,
    MOST_BYTES,
    Form,
    Outbox,
    Publication,
    Subscription,
)
from tests.api.rosbridge.test_publication import payloads


class Port:
    """A connection that takes frames while it is open."""

    def __init__(self):
        self.is_open = True
        self.sent = []

    def write_frame(self, wire):
        """Take frames."""
        self.sent += [json.loads(data) for data in payloads(wire)]

    def is_writable(self):
        """Return whether the client reads."""
        return self.is_open


@pytest.fixture
def port():
    return Port()


@pytest.fixture
def outbox(port):
    return Outbox(port, 0.005)


def subscribe(outbox, throttle=0.0, length=0):
    one = Subscription({"a": (throttle, length, Form())})
    one.settle()
    outbox.subscriptions["/t"] = one


def offer(outbox, *numbers, period=0.01):
    for number in numbers:
        message = {"data": str(number)}
        outbox.offer(Publication("/t", "std_msgs/String", message, 0), number * period)


def numbers(port):
    sent = [one for one in port.sent if one["op"] == "publish"]
    return [int(one["msg"]["data"]) for one in sent if one["topic"] == "/t"]


@pytest.mark.parametrize(("length", "kept"), [(0, [9]), (1, [9]), (3, [7, 8, 9])])
def test_a_client_that_does_not_read_loses_the_oldest(outbox, port, length, kept):
    subscribe(outbox, length=length)
    port.is_open = False
    offer(outbox, *range(10))
    assert port.sent == []
    port.is_open = True
    outbox.flush(0.2)
    assert numbers(port) == kept
    (status,) = [one for one in port.sent if one["op"] == "status"]
    assert status["msg"].startswith(f"{10 - len(kept)} messages of /t were lost")
    assert outbox.subscriptions["/t"].lost == 0


def test_large_messages_that_wait_are_limited_in_bytes_and_the_small_ones_stay(
    outbox, port
):
    subscribe(outbox, length=100)
    outbox.subscriptions["/picture"] = Subscription({"a": (0.0, 100, Form())})
    outbox.subscriptions["/picture"].settle()
    port.is_open = False
    offer(outbox, 0)
    picture = {"data": b"\xff" * (MOST_BYTES // 20)}
    for _ in range(20):
        outbox.offer(Publication("/picture", "sensor_msgs/Image", picture, 0), 0.1)
    offer(outbox, 1)
    assert sum(one.size for one in outbox.subscriptions.values()) <= MOST_BYTES
    port.is_open = True
    outbox.flush(0.2)
    assert numbers(port) == [0, 1]
    assert outbox.subscriptions["/picture"].size == 0
    # In base64 each has a third more bytes, so that 14 of the 20 fit.
    (status,) = [one for one in port.sent if one["op"] == "status"]
    assert status["msg"].startswith("6 messages of /picture were lost")


def test_what_is_throttled_is_not_lost(outbox, port):
    subscribe(outbox, throttle=0.05)
    offer(outbox, *range(21))
    outbox.flush(0.21)
    assert numbers(port) == [0, 5, 10, 15, 20]
    assert [one["op"] for one in port.sent] == ["publish"] * 5


def test_a_queue_is_sent_at_the_throttle_rate(outbox, port):
    subscribe(outbox, throttle=0.05, length=2)
    offer(outbox, *range(6))
    assert numbers(port) == [0, 4]
    outbox.flush(0.1)
    assert numbers(port) == [0, 4, 5]


def test_answers_wait_and_keep_their_order(outbox, port):
    port.is_open = False
    for number in range(MOST_ANSWERS):
        outbox.answer({"number": number})
    assert not outbox.overflown.is_set()
    outbox.answer({"number": MOST_ANSWERS})
    assert outbox.overflown.is_set()
    port.is_open = True
    outbox.answer({"number": -1})
    assert [one["number"] for one in port.sent] == [*range(MOST_ANSWERS + 1), -1]


def test_two_wishes_are_served_together():
    one = Subscription({"a": (0.2, 1, Form("png")), "b": (0.1, 5, Form("cbor"))})
    one.settle()
    assert (one.throttle, one.length, one.form.compression) == (0.1, 5, "cbor")
