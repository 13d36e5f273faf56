"""Joint commands on their way to the arm: smooth, within limits, unchanged if fine."""

import math
import random
from dataclasses import replace
from math import cos

import pytest

from station.core.franka.franka_robot_state import RobotState
from station.core.numerics.command_rates import filter_commands
from station.hw.franka.arm.arm_limits import (
    FR3_LIMITS,
    PANDA_LIMITS,
    ArmLimits,
    MotionLimits,
)
from station.hw.franka.arm.control_mode import ControlMode
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.commands.joint_commands import JointCommands
from station.hw.franka.commands.rate_limiter import (
    PERIOD,
    CommandSettings,
    low_pass_gain,
    make_joint_rates,
    make_velocity_curves,
    rate_limits_of,
)
from station.memory.doubles import doubles, put
from tests.hw.franka.limited_commands import limit_position, limit_velocity

RATE_LIMITS = rate_limits_of(PANDA_LIMITS)
LIMITS = RATE_LIMITS[0]


def test_limits_of_the_panda_carry_libfrankas_margins() -> None:
    velocities = [2.12900, 2.15150, 2.14400, 2.13650, 2.56400, 2.54900, 2.54900]
    # Published to 5 digits; the margins' products add 3e-6.
    assert [limits.velocity for limits in RATE_LIMITS] == pytest.approx(
        velocities, abs=5e-6
    )
    assert LIMITS.acceleration == pytest.approx(14.999)
    assert LIMITS.jerk == pytest.approx(7499.999)


def test_low_pass_of_100_hz_has_the_published_gain() -> None:
    assert low_pass_gain(100.0) == pytest.approx(0.3859, abs=5e-5)


def test_low_pass_settles_like_a_first_order_filter() -> None:
    value, one = doubles([0.0]), doubles([1.0])
    for _ in range(100):
        filter_commands(one, value, low_pass_gain(10.0), math.inf, value, 1)
    # Backward Euler of tau = 1 / (2 pi f): (1 + dt / tau)^-n.
    assert value[0] == pytest.approx(1.0 - (1.0 + PERIOD * 20.0 * math.pi) ** -100)


@pytest.mark.parametrize("cutoff", [1000.0, 5000.0])
def test_low_pass_is_off_from_1000_hz_on(cutoff: float) -> None:
    assert low_pass_gain(cutoff) == 1.0


def test_velocity_within_the_limits_passes() -> None:
    assert limit_velocity(0.005, 0.0, 0.0, LIMITS) == pytest.approx(0.005, abs=1e-15)


def test_velocity_step_from_rest_rises_with_the_jerk_limit() -> None:
    velocity = limit_velocity(1.0, 0.0, 0.0, MotionLimits(2.0, 10.0, 1000.0))
    assert velocity == pytest.approx(1000.0 * PERIOD * PERIOD)


@pytest.mark.parametrize("limits", RATE_LIMITS)
def test_random_velocities_never_break_a_limit(limits: MotionLimits) -> None:
    rng = random.Random(5)
    last, acceleration = 0.0, 0.0
    for _ in range(5_000):
        velocity = limit_velocity(rng.uniform(-5, 5), last, acceleration, limits)
        new_acceleration = (velocity - last) / PERIOD
        assert abs(velocity) <= limits.velocity + 1e-12
        assert abs(new_acceleration) <= limits.acceleration + 1e-9
        last, acceleration = velocity, new_acceleration


def test_position_command_within_the_limits_passes() -> None:
    q = dq = ddq = 0.0
    for cycle in range(1, 2_000):
        wanted = 0.5 * (1.0 - math.cos(1.5 * cycle * PERIOD))
        reached = limit_position(wanted, q, dq, ddq, LIMITS)
        assert reached == pytest.approx(wanted, abs=1e-12)
        velocity = (reached - q) / PERIOD
        q, dq, ddq = reached, velocity, (velocity - dq) / PERIOD


def make(
    *,
    cutoff_frequency: float = 1000.0,
    rate_limiting: bool = True,
    arm: ArmLimits = PANDA_LIMITS,
) -> tuple["Filter", RobotState]:
    state = RobotState()
    return Filter(arm, state, cutoff_frequency, rate_limiting), state


class Filter:
    """A filter that is given its commands call by call."""

    def __init__(self, arm, state, cutoff_frequency, rate_limiting) -> None:
        self.commands = JointCommands(state, [f"joint{i}" for i in range(7)])
        self.rates = make_joint_rates(arm, state, self.commands)
        self.state, self.curves = state, make_velocity_curves(arm)
        self.rates.begin_motion(low_pass_gain(cutoff_frequency), rate_limiting)

    def positions(self, q, state, *, goals) -> list[float]:
        put(self.commands.positions, goals)
        self.rates.note_goals()
        put(self.commands.positions, q)
        self._update_ranges()
        self.rates.filter_positions()
        return [*self.rates.result]

    def velocities(self, dq, state) -> list[float]:
        put(self.commands.velocities, dq)
        self._update_ranges()
        self.rates.filter_velocities()
        return [*self.rates.result]

    def torques(self, tau, state) -> list[float]:
        put(self.commands.efforts, tau)
        self.rates.filter_torques()
        return [*self.rates.result]

    def _update_ranges(self) -> None:
        if self.curves is not None:
            q_d = self.state.doubles("q_d")
            self.curves.put(q_d, self.rates.lowest, self.rates.highest)


def follow(state: RobotState, q: list[float]) -> None:
    """Take over positions as the arm does."""
    dq = [(new - old) / PERIOD for new, old in zip(q, state.q_d, strict=True)]
    ddq = [(new - old) / PERIOD for new, old in zip(dq, state.dq_d, strict=True)]
    state.q_d, state.dq_d, state.ddq_d = q, dq, ddq


@pytest.mark.parametrize("cutoff", [100.0, 1000.0])
@pytest.mark.parametrize("step", [0.001, 0.05, -0.3, 1.5])
def test_position_step_is_approached_without_overshoot(
    cutoff: float, step: float
) -> None:
    command_filter, state = make(cutoff_frequency=cutoff)
    farthest = 0.0
    for _ in range(2_000):
        q = command_filter.positions([step] * 7, state, goals=[step] * 7)
        follow(state, q)
        farthest = max(farthest, *(value / step for value in q))
    assert state.q_d == pytest.approx([step] * 7, abs=1e-9)
    assert farthest <= 1.0 + 1e-9


def test_position_steps_keep_velocity_and_acceleration_limits() -> None:
    command_filter, state = make()
    for cycle in range(3_000):
        goal = [0.8 if cycle % 600 < 300 else -0.8] * 7
        follow(state, command_filter.positions(goal, state, goals=goal))
        for dq, ddq, limits in zip(state.dq_d, state.ddq_d, RATE_LIMITS, strict=True):
            assert abs(dq) <= limits.velocity + 1e-9
            # Differences of positions of 1 rad over 1 ms, twice: 1e-16 / 1e-6.
            assert abs(ddq) <= limits.acceleration + 1e-6


def test_smooth_positions_pass_unchanged() -> None:
    command_filter, state = make()
    for cycle in range(2_000):
        wanted = [0.3 * (1.0 - cos(3.0 * cycle * PERIOD))] * 7
        follow(state, command_filter.positions(wanted, state, goals=wanted))
        assert state.q_d == pytest.approx(wanted, abs=1e-12)


@pytest.mark.parametrize("joint", range(7))
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_fr3_slows_down_towards_its_position_limits(joint: int, side: float) -> None:
    command_filter, state = make(arm=FR3_LIMITS)
    # Slow enough for 10 rad/s^2 to follow any of the curves: 34 / 2 * v / (v + 0.35).
    # The limiter brakes in proportion to how much too fast it is, so it comes late.
    late = 10.0**2 / 5000.0
    bound = (FR3_LIMITS.upper if side > 0.0 else FR3_LIMITS.lower)[joint]
    state.q_d = [0.0, 0.0, 0.0, -1.5, 0.0, 2.5, 0.0]
    state.doubles("q_d")[joint] = bound - 0.3 * side
    speed = [0.0] * 7
    speed[joint] = 0.4 * side
    for _ in range(3_000):
        dq = command_filter.velocities(speed, state)
        lowest, highest = FR3_LIMITS.velocity_range(joint, state.q_d[joint])
        assert lowest - late <= dq[joint] <= highest + late
        rise = [new - old for new, old in zip(dq, state.dq_d, strict=True)]
        assert abs(rise[joint]) <= FR3_LIMITS.acceleration[joint] * PERIOD
        follow(state, [q + v * PERIOD for q, v in zip(state.q_d, dq, strict=True)])
    assert state.q_d[joint] == pytest.approx(bound, abs=0.01)


def test_fr3_takes_its_first_position_unfiltered() -> None:
    command_filter, state = make(
        cutoff_frequency=100.0, rate_limiting=False, arm=FR3_LIMITS
    )
    first = command_filter.positions([1e-6] * 7, state, goals=[1e-6] * 7)
    assert first == [1e-6] * 7
    follow(state, first)
    second = command_filter.positions([2e-6] * 7, state, goals=[2e-6] * 7)
    assert second == pytest.approx([1.3859e-6] * 7, abs=1e-10)


def test_torque_step_rises_with_1000_newton_metres_per_second() -> None:
    command_filter, state = make()
    tau = command_filter.torques([50.0, -50.0, 0.5, 0.0, 0.0, 0.0, 0.0], state)
    assert tau == pytest.approx([1.0, -1.0, 0.5, 0.0, 0.0, 0.0, 0.0], abs=1e-5)


def test_velocity_step_keeps_the_acceleration_limits() -> None:
    command_filter, state = make()
    for _ in range(2):
        dq = command_filter.velocities([2.0] * 7, state)
        rise = [new - old for new, old in zip(dq, state.dq_d, strict=True)]
        state.ddq_d = [value / PERIOD for value in rise]
        state.dq_d = dq
    assert rise == pytest.approx([
        limits.acceleration * PERIOD for limits in RATE_LIMITS
    ])


def test_without_limits_only_the_low_pass_acts() -> None:
    command_filter, state = make(cutoff_frequency=100.0, rate_limiting=False)
    for values in (
        command_filter.torques([1.0] * 7, state),
        command_filter.velocities([1.0] * 7, state),
        command_filter.positions([1.0] * 7, state, goals=[1.0] * 7),
    ):
        assert values == pytest.approx([0.3859] * 7, abs=5e-5)


SETTINGS = CommandSettings(
    rate_limiting=True,
    cutoff_frequency=100.0,
    internal_controller=ControllerMode.CARTESIAN_IMPEDANCE,
)


@pytest.mark.parametrize(
    ("mode", "controller", "generator"),
    [
        (1, ControllerMode.EXTERNAL_CONTROLLER, MotionGeneratorMode.NONE),
        (2, SETTINGS.internal_controller, MotionGeneratorMode.JOINT_POSITION),
        (5, ControllerMode.EXTERNAL_CONTROLLER, MotionGeneratorMode.JOINT_VELOCITY),
        (8, SETTINGS.internal_controller, MotionGeneratorMode.CARTESIAN_VELOCITY),
        (
            17,
            ControllerMode.EXTERNAL_CONTROLLER,
            MotionGeneratorMode.CARTESIAN_POSITION,
        ),
    ],
)
def test_torque_command_replaces_the_internal_controller(mode, controller, generator):
    joint = ControllerMode.JOINT_IMPEDANCE
    assert SETTINGS.arm_modes(ControlMode(mode), joint) == (controller, generator)


@pytest.mark.parametrize(
    ("mode", "set_last", "acts"),
    [
        (8, "joint", "joint"),
        (8, "cartesian", "cartesian"),
        (16, "cartesian", "cartesian"),
        (2, "cartesian", "joint"),
        (4, "cartesian", "joint"),
    ],
)
def test_impedance_that_was_set_last_acts_in_cartesian_motions(mode, set_last, acts):
    settings = replace(SETTINGS, internal_controller=None)
    impedance = ControllerMode(f"{set_last}_impedance")
    controller, _ = settings.arm_modes(ControlMode(mode), impedance)
    assert controller is ControllerMode(f"{acts}_impedance")
