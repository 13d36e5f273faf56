"""Values that pass between threads: the newest one, for one reader or for everybody."""

from station.core.toolbox.realtime import RealtimeBox, RealtimeBuffer


def test_the_first_value_is_not_new():
    buffer = RealtimeBuffer((1.0,))

    assert not buffer.has_new()
    assert buffer.read_from_rt() == (1.0,)


def test_a_written_value_is_new_until_it_is_read():
    buffer = RealtimeBuffer((1.0,))
    buffer.write_from_non_rt((2.0,))
    assert buffer.has_new()

    assert buffer.read_from_rt() == (2.0,)

    assert not buffer.has_new()


def test_only_the_newest_value_is_read():
    buffer = RealtimeBuffer((1.0,))
    buffer.write_from_non_rt((2.0,))
    buffer.write_from_non_rt((3.0,))

    assert buffer.read_from_non_rt() == (3.0,)
    assert buffer.read_from_rt() == (3.0,)


def test_a_value_set_by_the_control_thread_is_not_new():
    buffer = RealtimeBuffer((1.0,))
    buffer.write_from_non_rt((2.0,))

    buffer.init_rt((3.0,))

    assert not buffer.has_new()
    assert buffer.read_from_non_rt() == (3.0,)


def test_the_box_holds_its_first_value():
    assert RealtimeBox(3).get() == 3


def test_the_newest_value_replaces_the_others():
    box = RealtimeBox(1)

    box.set(2)
    box.set(3)

    assert box.get() == 3
