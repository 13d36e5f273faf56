"""The latched stop: immediate to engage, two steps to release."""

import pytest

from station.core.errors import StoppedError
from station.core.loop.stop_latch import StopLatch, StopState


def _stopped() -> StopLatch:
    latch = StopLatch()
    latch.engage("test")
    latch.carried_out(7)
    return latch


def test_a_new_latch_lets_motion_pass():
    StopLatch().check()
    assert StopLatch().state is StopState.ARMED


def test_engaging_refuses_motion_at_once_and_names_the_reason():
    latch = StopLatch()
    latch.engage("somebody pressed the button")
    assert latch.pending
    with pytest.raises(StoppedError, match="somebody pressed the button"):
        latch.check()


def test_release_alone_does_not_allow_motion():
    latch = _stopped()
    latch.release()
    assert latch.state is StopState.RELEASED
    with pytest.raises(StoppedError, match="released"):
        latch.check()


def test_release_then_arm_allows_motion():
    latch = _stopped()
    latch.release()
    latch.arm()
    latch.check()
    assert latch.state is StopState.ARMED


def test_arming_without_release_is_refused():
    latch = _stopped()
    with pytest.raises(StoppedError, match="release it before arming"):
        latch.arm()
    assert latch.state is StopState.STOPPED


def test_a_stop_that_arrives_between_release_and_arm_wins():
    latch = _stopped()
    latch.release()
    latch.engage("again")
    with pytest.raises(StoppedError):
        latch.arm()


def test_a_stop_not_yet_carried_out_cannot_be_released():
    latch = StopLatch()
    latch.engage("test")
    with pytest.raises(StoppedError, match="not carried out yet"):
        latch.release()
    assert latch.state is StopState.STOPPED


class InterruptedLatch(StopLatch):
    """Another thread stops in the middle of the next release or arming."""

    def __setattr__(self, name, value):
        interrupted = name == "state" and self.__dict__.pop("interrupt", False)
        if interrupted:
            self.engage("another thread")
            self.carried_out(8)
        super().__setattr__(name, value)


@pytest.mark.parametrize("step", ["release", "arm"])
def test_a_stop_in_the_middle_of_a_release_or_arming_wins(step):
    latch = InterruptedLatch()
    latch.engage("test")
    latch.carried_out(7)
    if step == "arm":
        latch.release()
    latch.interrupt = True

    getattr(latch, step)()

    assert latch.state is StopState.STOPPED
