"""The newest value, for everybody."""

from station.core.toolbox.realtime import RealtimeBox


def test_the_box_holds_its_first_value():
    assert RealtimeBox(3).get() == 3


def test_the_newest_value_replaces_the_others():
    box = RealtimeBox(1)

    box.set(2)
    box.set(3)

    assert box.get() == 3
