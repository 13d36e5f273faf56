"""How many cycles of an arm a cycle of the loop has."""

from math import inf

import pytest

from station.hw.franka.commands.arm_cycles import ArmCycles
from tests.hw.franka.scripted_arm import ScriptedArm


class Sender:
    """Counts the commands that are sent again."""

    bridges_gaps = False

    def __init__(self):
        self.repeated = 0

    def send_again(self):
        self.repeated += 1


@pytest.mark.parametrize(
    ("nominal", "periods", "cycles", "repeated"),
    [
        (1, [0.001, 0.001], 2, 0),
        (1, [0.0004, 0.0004, 0.0004], 1, 0),
        (1, [0.005], 5, 0),
        (4, [0.004, 0.004], 8, 6),
        (1, [0.0], 0, 0),
    ],
)
def test_arm_is_read_once_per_elapsed_cycle(nominal, periods, cycles, repeated):
    arm, sender = ScriptedArm(), Sender()
    counted = ArmCycles(arm, sender, 20)
    counted.nominal = nominal
    assert sum(counted.read(period) for period in periods) == cycles
    assert arm.state.time == pytest.approx(cycles * 0.001)
    assert sender.repeated == repeated


def test_cycles_beyond_the_longest_gap_are_not_made():
    arm = ScriptedArm()
    counted = ArmCycles(arm, Sender(), 19)
    assert counted.read(0.3) == 300
    assert arm.state.time == pytest.approx(0.020)
    assert counted.longest_period() == pytest.approx(0.020)
    assert ArmCycles(arm, Sender(), 20).longest_period() == inf
