"""A loop whose robot has a clock of its own."""

import pytest

from station.core.clock import ManualClock
from station.core.loop.stop_latch import StopState
from tests.core.loop.one_joint import PERIOD, OneJoint, make_loop
from tests.waiting import PATIENCE


class PacedJoint(OneJoint):
    """A joint with a clock of its own: what each wait tells is written down."""

    def __init__(self, *waits):
        super().__init__()
        self.waits = list(waits)
        self.loop = None

    def robot_clock(self):
        return self

    def wait(self):
        if not self.waits:
            self.loop.stop_latch.engage("the script is over")
            self.loop._stopping = True
            return 0
        return self.waits.pop(0)


def test_robot_with_a_clock_paces_the_thread_and_lost_states_lengthen_a_period():
    hw = PacedJoint(1, 1, 0, 0, 4, 1)
    loop = hw.loop = make_loop(hw)
    loop.start()
    loop._thread.join(PATIENCE)
    loop.stop()
    assert [period for period in hw.periods if period] == pytest.approx([
        PERIOD,
        PERIOD,
        4 * PERIOD,
        PERIOD,
    ])
    assert loop.time == pytest.approx(7 * PERIOD)
    assert loop.skipped == 3


def test_stop_is_carried_out_while_a_robot_with_a_clock_is_silent():
    hw = PacedJoint(1, 0, 0)
    loop = hw.loop = make_loop(hw)
    loop.start()
    loop._thread.join(PATIENCE)
    loop.stop()
    assert loop.stop_latch.state is StopState.STOPPED
    assert loop.time == pytest.approx(PERIOD)


def test_lateness_is_counted_from_the_state_before():
    clock = ManualClock()
    arrivals = [(1, 0.0011), (1, 0.0020), (0, 0.0060), (3, 0.0082)]
    begin = clock.now()

    class Arriving(PacedJoint):
        def wait(self):
            if not self.waits:
                return super().wait()
            elapsed, clock.seconds = self.waits[0][0], begin + self.waits.pop(0)[1]
            return elapsed

    hw = Arriving(*arrivals)
    loop = hw.loop = make_loop(hw, clock)
    loop.start()
    loop._thread.join(PATIENCE)
    loop.stop()
    report = loop.report()
    assert report.lateness.max == pytest.approx(0.0032, abs=1e-8)
    assert report.lateness.p50 == pytest.approx(0.0001, abs=1e-8)
    assert (report.lateness.count, report.skipped) == (3, 2)
