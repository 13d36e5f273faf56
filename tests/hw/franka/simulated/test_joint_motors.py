"""Motors that act on commands in the next cycle, and motors that act at once."""

import pytest
from hypothesis import given

from station.memory.doubles import doubles, put, zeros
from tests.both_modes import arrays, assert_same, compiled, needs_both, sibling

SIZE = 2


class Bench:
    """Two motors over plain memory."""

    def __init__(self, module, *, is_late: bool) -> None:
        self.q_d = zeros(SIZE)
        self.memory = sibling(module, "joint_memory").JointMemory(SIZE, q_d=self.q_d)
        self.controls = zeros(SIZE)
        simulator = sibling(module, "simulator_memory").SimulatorMemory(
            SIZE, controls=self.controls, limits=doubles([10.0] * SIZE)
        )
        self.motors = module.JointMotors(self.memory, simulator, 0.001)
        self.motors.is_late = is_late
        self.engage()

    def engage(self) -> None:
        """Let an impedance act anew."""
        self.motors.engage([100.0] * SIZE, [0.0] * SIZE)

    def torques(self, *wanted: float) -> list[list[float]]:
        """Return the controls of one cycle after another."""
        self.engage()
        self.motors.torques_act = True
        found = []
        for torque in wanted:
            put(self.memory.torques, [torque, -torque])
            self.motors.apply_torques()
            assert list(self.memory.tau_J_d) == [torque, -torque]
            found.append(self.controls.tolist())
        return found

    def positions(self, *wanted: float) -> list[float]:
        """Return the first control of one cycle after another."""
        self.engage()
        found = []
        for position in wanted:
            put(self.q_d, [position, 0.0])
            self.motors.apply_impedance(notes=False)
            found.append(self.controls[0])
        return found


def test_late_motors_give_a_torque_one_cycle_after_it_was_wanted():
    bench = Bench(compiled("joint_motors"), is_late=True)
    assert bench.torques(1.0, 2.0, 3.0) == [[0.0, 0.0], [1.0, -1.0], [2.0, -2.0]]


def test_late_motors_follow_a_motion_one_cycle_later():
    bench = Bench(compiled("joint_motors"), is_late=True)
    assert bench.positions(0.1, 0.2, 0.3) == pytest.approx([10.0, 10.0, 20.0])


def test_another_impedance_begins_where_the_arm_is():
    """Where the arm was going before does not matter any more."""
    bench = Bench(compiled("joint_motors"), is_late=True)
    bench.positions(2.0)
    assert bench.positions(0.1) == pytest.approx([10.0])


def test_torques_that_the_arm_computes_act_at_once():
    bench = Bench(compiled("joint_motors"), is_late=True)
    bench.engage()
    put(bench.memory.torques, [1.0, -1.0])
    bench.motors.apply_torques()
    assert bench.controls.tolist() == [1.0, -1.0]


def test_ideal_motors_act_at_once():
    bench = Bench(compiled("joint_motors"), is_late=False)
    assert bench.torques(1.0, 2.0) == [[1.0, -1.0], [2.0, -2.0]]
    assert bench.positions(0.1, 0.2) == pytest.approx([10.0, 20.0])


@needs_both
@given(arrays(3))
def test_both_modes_are_late_in_the_same_way(values):
    def run(module):
        return Bench(module, is_late=True).positions(*values)

    assert_same("joint_motors", run)
