"""Publishing never makes the control thread wait."""

import threading

import pytest

from station.core.toolbox.realtime import RealtimePublisher
from tests.waiting import PATIENCE


@pytest.fixture
def gate():
    """A lock that holds the publishing thread back."""
    return threading.Semaphore(0)


def test_messages_are_published_in_order():
    seen, arrived = [], threading.Semaphore(0)

    def publish(message):
        seen.append(message)
        arrived.release()

    with RealtimePublisher(publish) as publisher:
        for number in range(1, 4):
            assert publisher.try_publish(number)
            assert arrived.acquire(timeout=PATIENCE)

    assert seen == [1, 2, 3]
    assert publisher.dropped == 0


def test_what_nobody_has_picked_up_yet_drops_the_next(gate):
    seen, begun = [], threading.Semaphore(0)

    def slow(message):
        begun.release()
        gate.acquire()
        seen.append(message)

    with RealtimePublisher(slow) as publisher:
        assert publisher.try_publish("first")
        assert begun.acquire(timeout=PATIENCE)
        assert publisher.try_publish("second")
        assert not publisher.try_publish("third")
        gate.release(2)

    assert seen == ["first", "second"]
    assert publisher.dropped == 1


def test_before_the_start_one_message_waits():
    seen = []
    publisher = RealtimePublisher(seen.append)
    assert publisher.try_publish("first")
    assert not publisher.try_publish("second")

    with publisher:
        pass

    assert seen == ["first"]


def test_a_failed_publication_is_kept_and_does_not_end_the_thread():
    seen = []

    def publish(message):
        if message == "bad":
            raise RuntimeError("no network")
        seen.append(message)

    publisher = RealtimePublisher(publish)
    for message in ("bad", "good"):
        with publisher:
            assert publisher.try_publish(message)

    assert seen == ["good"]
    assert publisher.failed == 1
    assert "no network" in publisher.failure


def test_starting_and_stopping_twice_is_fine():
    publisher = RealtimePublisher([].append)

    publisher.start()
    publisher.start()
    publisher.stop()
    publisher.stop()

    assert publisher.failed == 0
