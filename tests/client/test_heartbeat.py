"""A heartbeat in a thread."""

import threading

import pytest

from station.client.errors import ApiError, StationUnreachableError
from station.client.heartbeat import Heartbeat


def test_it_beats_until_it_is_stopped():
    thrice = threading.Semaphore(0)
    heart = Heartbeat(thrice.release, 0.001)
    heart.start()
    for _ in range(3):
        assert thrice.acquire(timeout=5.0)
    heart.stop()

    assert heart.refusal is None


def test_it_goes_on_without_a_link_and_ends_with_a_refusal():
    refusal = ApiError("no", status=423, code="control_held", remedy="")
    beats = [StationUnreachableError("u", OSError()), refusal]

    def beat():
        raise beats.pop(0)

    heart = Heartbeat(beat, 0.001)
    heart.start()
    heart._thread.join(5.0)

    assert heart.refusal is refusal
    with pytest.raises(IndexError):
        beats.pop()
