"""Which periods of a loop an arm can live with."""

import logging

import pytest

from station.core.errors import HardwareInterfaceError
from station.hw.franka.arm.loop_period import arm_cycles_of


@pytest.mark.parametrize(("period", "cycles"), [(0.001, 1), (0.0015, 2), (0.004, 4)])
def test_slower_loop_has_several_cycles_of_the_arm(period, cycles):
    assert arm_cycles_of(period, 0.001, "panda") == cycles


def test_loop_faster_than_the_arm_is_refused():
    with pytest.raises(HardwareInterfaceError, match="2000 Hz; arm 'panda'") as error:
        arm_cycles_of(0.0005, 0.001, "panda")
    assert "1000 or less" in error.value.remedy


def test_loop_too_slow_for_torques_is_warned_of(caplog):
    with caplog.at_level(logging.WARNING):
        arm_cycles_of(0.01, 0.001, "panda")
    assert "100 Hz" in caplog.text
