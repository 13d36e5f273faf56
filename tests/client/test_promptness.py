"""Changes say until when they may begin, by the station's clock."""

from station.client.promptness import CLOCK_HEADER, NOT_AFTER_HEADER, Promptness
from station.core.clock import ManualClock


def test_a_change_may_begin_for_some_time_by_the_stations_clock():
    clock = ManualClock()
    prompt = Promptness(3.0, clock.now)
    assert prompt.headers() == {}
    prompt.hear({CLOCK_HEADER: "1000.25"})
    clock.advance(2.0)
    prompt.hear({})
    prompt.hear({CLOCK_HEADER: "1000.5"})  # read late
    assert prompt.headers() == {NOT_AFTER_HEADER: "1005.250"}
    for _ in range(20):  # The station's clock was put back.
        prompt.hear({CLOCK_HEADER: "900.0"})
    assert prompt.headers() == {NOT_AFTER_HEADER: "903.000"}
