"""Friction, noise and the observer give the same bits in both modes."""

from dataclasses import replace
from math import exp, inf

import numpy as np
import pytest
from hypothesis import given, strategies as st

from station.core.franka import Frame
from station.core.franka.joint_memory import JointMemory
from station.hw.franka.arm.franka_kinematics import (
    CHAIN,
    IDENTITY,
    frame_pose,
    zero_jacobian,
)
from station.hw.franka.simulated.realism import TYPICAL
from station.hw.mujoco.simulator_memory import SimulatorMemory
from station.memory.doubles import doubles, put, zeros
from tests.both_modes import arrays, assert_same, compiled, needs_both, sibling

_CYCLES = 3


def translated(z):
    """Return the pose of a frame that is moved along z."""
    return doubles([*IDENTITY[:14], z, 1.0])


def ideal(size, **others):
    """Return an arm of some joints with no deviations but those that are given."""
    names = (
        "friction_level", "friction_slope", "friction_shift", "viscous", "torque_noise",
        "static_friction", "torque_bias", "velocity_noise", "model_error",
    )  # fmt: skip
    none = dict.fromkeys(names, (0.0,) * size)
    rigid = {"joint_stiffness": (inf,) * size, "stribeck_velocity": 1.0}
    return replace(TYPICAL, **{**none, **rigid, "presliding": 1.0, **others})


def fields_of(size, tool=IDENTITY, stiffness_frame=IDENTITY):
    """Return the fields of a state that the observer reads and writes, by name."""
    return {
        "F_T_EE": doubles(tool),
        "EE_T_K": doubles(stiffness_frame),
        "tau_ext_hat_filtered": zeros(size),
        "theta": zeros(size),
        "O_F_ext_hat_K": zeros(6),
        "K_F_ext_hat_K": zeros(6),
    }


class Bench:
    """A joint pair with everything that disturbs it."""

    def __init__(self, module, values, **others) -> None:
        self.memory = sibling(module, "joint_memory").JointMemory(2)
        # Rows of the inertia matrix: (M00), (M10, M11).
        diagonal = memoryview(bytearray(16)).cast("l")
        diagonal[0], diagonal[1] = 0, 2
        self.simulator = sibling(module, "simulator_memory").SimulatorMemory(
            2,
            inertia=doubles([1.5, 0.3, 0.8]),
            diagonal=diagonal,
            armature=doubles([0.1, 0.1]),
        )
        fields = fields_of(2)
        self.estimate, self.theta = fields["tau_ext_hat_filtered"], fields["theta"]
        self.wrench, self.turned = fields["O_F_ext_hat_K"], fields["K_F_ext_hat_K"]
        names = ("friction_level", "friction_slope", "friction_shift", "torque_noise")
        given = {
            **dict.fromkeys((*names, "torque_bias"), values[:2]),
            "velocity_noise": values[1:3],
            "model_error": values[2:4],
            "static_friction": (0.5, 1.0),
            "joint_stiffness": (1e3, 1e4),
            "stribeck_velocity": 0.02,
            "presliding": 1e-4,
        }
        self.part = module.FrictionAndObserver(
            self.memory,
            self.simulator,
            ideal(2, **{**given, **others}),
            fields=fields.__getitem__,
            chain=zeros(12),
            noise=doubles([0.5, -1.0, 2.0, 0.1, -0.3]),
            period=0.001,
        )
        put(self.part.lower, [0.5] * 8)
        self.part.gain = 0.1
        self.part.reach = 0.01
        self.part.lasting_gain = 0.05
        self.values = values

    def results(self) -> list[float]:
        found = []
        for cycle in range(_CYCLES):
            q = [value * (1.0 + cycle) for value in self.values]
            put(self.memory.positions, q[:2])
            put(self.memory.dtheta, q[1:3])
            put(self.memory.tau_J, q[2:4])
            put(self.simulator.velocities, q[:2])
            put(self.simulator.bias, q[1:3])
            self.part.prepare_step()
            found += [self.part.sense(), *self.simulator.applied, *self.memory.dq]
            found += [*self.memory.tau_J, *self.estimate, *self.wrench, *self.turned]
            found += self.theta
        return found


@needs_both
@given(st.one_of(arrays(4), st.lists(st.floats(-2.0, 2.0), min_size=4, max_size=4)))
def test_both_modes_disturb_the_same(values):
    assert_same("friction_and_observer", lambda module: Bench(module, values).results())


def test_the_estimate_is_what_the_motion_does_not_explain():
    bench = Bench(compiled("friction_and_observer"), [0.0] * 4)
    bench.part.gain = 1.0
    put(bench.memory.dtheta, [0.002, -0.001])  # in one cycle from rest
    put(bench.memory.tau_J, [5.0, 1.0])
    put(bench.simulator.bias, [0.5, 0.25])
    assert bench.part.sense() == compiled("friction_and_observer").TOUCHED
    # Without the rotors: 1.4 and 0.7 on the diagonal, 0.3 beside it.
    assert bench.estimate.tolist() == pytest.approx([
        5.0 - (1.4 * 2.0 - 0.3 * 1.0) - 0.5,
        1.0 - (0.3 * 2.0 - 0.7 * 1.0) - 0.25,
    ])


def test_friction_is_the_published_formula_and_zero_at_rest():
    bench = Bench(
        compiled("friction_and_observer"),
        [0.0] * 4,
        friction_level=(0.8, 0.8),
        friction_slope=(5.0, 5.0),
        friction_shift=(0.02, 0.02),
        static_friction=(0.0, 0.0),
    )
    put(bench.simulator.velocities, [0.0, 0.7])
    bench.part.prepare_step()
    at_rest, moving = bench.simulator.applied
    assert at_rest == 0.0
    assert moving == pytest.approx(0.8 / (1 + exp(-0.1)) - 0.8 / (1 + exp(-3.6)))


def test_a_joint_that_sticks_holds_against_every_torque_up_to_the_static_friction():
    """It bends as a spring, and slides when its friction cannot grow further."""
    bench = Bench(compiled("friction_and_observer"), [0.0] * 4)
    found = []
    for _ in range(20):
        put(bench.simulator.velocities, [1e-8, 1e-2])
        bench.part.prepare_step()
        found.append(tuple(bench.simulator.applied))
    # 20 cycles at 1e-8 rad/s, and the damping: 5 ms times the speed.
    assert found[-1][0] == pytest.approx(-0.5 * (20e-11 + 5e-11) / 1e-4)
    assert [one[1] for one in found[10:]] == pytest.approx([-1.0 / 1.25] * 10)


def test_noise_has_no_tone_though_its_numbers_are_few():
    none = (0.0, 0.0)
    bench = Bench(
        compiled("friction_and_observer"),
        [0.0] * 4,
        velocity_noise=(1.0, 1.0),
        torque_noise=(1.0, 1.0),
    )
    rows = []
    for _ in range(4096):
        put(bench.memory.dtheta, none)
        put(bench.memory.tau_J, none)
        bench.part.sense()
        rows.append([*bench.memory.dq, *bench.memory.tau_J])
    found = np.array(rows) - np.mean(rows, axis=0)
    power = np.abs(np.fft.rfft(found, axis=0)[1:-1]) ** 2
    # The lines of white noise are exponentially distributed: one of 8188 is 20 times
    # the mean with a probability of 2e-5.
    assert np.max(power / power.mean(axis=0)) < 20.0


def test_the_static_friction_is_gone_at_speed():
    bench = Bench(compiled("friction_and_observer"), [0.0] * 4)
    put(bench.simulator.velocities, [2.0, -2.0])
    bench.part.prepare_step()
    assert [*bench.simulator.applied] == pytest.approx([0.0, 0.0], abs=2e-4)


def test_the_motor_turns_against_its_link_as_the_torque_demands():
    bench = Bench(compiled("friction_and_observer"), [0.0] * 4)
    put(bench.memory.positions, [0.1, 0.2])
    put(bench.memory.tau_J, [2.0, -3.0])
    bench.part.sense()
    assert bench.theta.tolist() == pytest.approx([0.102, 0.1997])


def test_no_speed_makes_the_friction_overflow():
    bench = Bench(compiled("friction_and_observer"), [1.0, 1.0, 1.0, 1.0])
    put(bench.simulator.velocities, [-1e308, 1e308])
    bench.part.prepare_step()
    assert [*bench.simulator.applied] == pytest.approx([0.7310585, -0.2689414])


def test_the_jacobian_is_computed_anew_where_a_joint_has_gone_far():
    q = [0.1, -0.8, 0.2, -2.3, 0.3, 1.5, 0.8]
    frames = (translated(0.1), translated(0.05))
    memory = JointMemory(7, positions=doubles(q))
    part = compiled("friction_and_observer").FrictionAndObserver(
        memory,
        SimulatorMemory(7, inertia=zeros(28)),
        ideal(7),
        fields=fields_of(7, *frames).__getitem__,
        chain=CHAIN,
        noise=zeros(14),
        period=0.001,
    )
    part.reach = 0.01
    part.sense()
    assert [*part.place] == q
    assert [*part.pose] == frame_pose(Frame.STIFFNESS, q, *frames)
    assert [*part.jacobian] == zero_jacobian(Frame.STIFFNESS, q, *frames)
    memory.positions[3] += 0.009
    part.sense()
    assert [*part.place] == q


class Arm:
    """Six joints, each of which turns the end effector about or along one axis."""

    def __init__(self, module) -> None:
        diagonal = memoryview(bytearray(48)).cast("l")
        for i in range(6):
            diagonal[i] = i * (i + 3) // 2
        self.memory = sibling(module, "joint_memory").JointMemory(6)
        fields = fields_of(6)
        self.wrench = fields["O_F_ext_hat_K"]
        self.part = module.FrictionAndObserver(
            self.memory,
            sibling(module, "simulator_memory").SimulatorMemory(
                6, inertia=zeros(21), diagonal=diagonal, armature=zeros(6)
            ),
            ideal(6),
            fields=fields.__getitem__,
            chain=zeros(28),
            noise=zeros(14),
            period=0.001,
        )
        self.part.gain, self.part.reach = 1.0, 1.0
        self.part.lasting_gain = 0.01
        self.part.singular, self.part.reliable = 0.05, 0.2
        # Joint 1 moves the end effector by 0.1 m/rad: 1 Nm looks like 10 N.
        arms = [0.1, 1.0, 1.0, 1.0, 1.0, 1.0]
        put(
            self.part.jacobian,
            [arms[i] if i == j else 0.0 for i in range(6) for j in range(6)],
        )
        assert self.part.factorise_jacobian()
        put(self.part.directions[:6], [1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
        put(self.part.shares[:6], [10.0, 0.0, 0.0, 0.0, 0.0, 0.0])
        self.part.doubt[0] = 15.0
        self.part.weak = 1

    def feel(self, torques, cycles):
        for _ in range(cycles):
            put(self.memory.tau_J, torques)
            self.part.sense()
        return list(self.wrench)


def test_what_lasts_is_left_out_of_a_weak_direction_up_to_its_doubt():
    arm = Arm(compiled("friction_and_observer"))
    assert arm.feel([1.0, 2.0, 0.0, 0.0, 0.0, 0.0], 50)[:2] == pytest.approx([0, 2])
    # A blow shows in full at once, and what lasts beyond the doubt for ever.
    assert arm.feel([3.0, 2.0, 0.0, 0.0, 0.0, 0.0], 1)[0] == pytest.approx(20, abs=1)
    assert arm.feel([3.0, 2.0, 0.0, 0.0, 0.0, 0.0], 2000)[0] == pytest.approx(15.0)
    arm.part.rest()
    assert arm.feel([-3.0, 0.0, 0.0, 0.0, 0.0, 0.0], 1)[0] == pytest.approx(-15.0)


def test_a_jacobian_without_a_weak_direction_leaves_the_wrench_alone():
    arm = Arm(compiled("friction_and_observer"))
    arm.part.reliable = 0.08
    assert not arm.part.factorise_jacobian()
    assert arm.feel([1.0, 0.0, 0.0, 0.0, 0.0, 0.0], 1)[0] == pytest.approx(10.0)


@needs_both
@given(st.lists(st.floats(-30.0, 30.0), min_size=6, max_size=6))
def test_both_modes_doubt_the_same(torques):
    def wrenches(module):
        arm = Arm(module)
        return arm.feel(torques, 1) + arm.feel([0.0] * 6, 3)

    assert_same("friction_and_observer", wrenches)
