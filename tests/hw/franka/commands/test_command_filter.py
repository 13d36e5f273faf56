"""Joint commands on their way to the arm: smooth, within limits, unchanged if fine."""

from math import cos

import pytest

from station.core.franka.franka_robot_state import RobotState
from station.hw.franka.arm.arm_limits import FR3_LIMITS, PANDA_LIMITS, ArmLimits
from station.hw.franka.commands.command_filter import CommandFilter
from station.hw.franka.commands.joint_commands import JointCommands
from station.hw.franka.commands.rate_limiter import PANDA_RATE_LIMITS, PERIOD
from station.memory.doubles import put


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
        self.filter = CommandFilter(arm, state, self.commands)
        self.filter.begin(
            cutoff_frequency=cutoff_frequency, rate_limiting=rate_limiting
        )

    def positions(self, q, state, *, goals) -> list[float]:
        put(self.commands.positions, goals)
        rates = self.filter.rates
        rates.note_goals()
        put(self.commands.positions, q)
        self._prepare()
        rates.filter_positions()
        return [*rates.result]

    def velocities(self, dq, state) -> list[float]:
        put(self.commands.velocities, dq)
        self._prepare()
        self.filter.rates.filter_velocities()
        return [*self.filter.rates.result]

    def torques(self, tau, state) -> list[float]:
        put(self.commands.efforts, tau)
        self.filter.rates.filter_torques()
        return [*self.filter.rates.result]

    def _prepare(self) -> None:
        if self.filter.prepare is not None:
            self.filter.prepare()


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
        for dq, ddq, limits in zip(
            state.dq_d, state.ddq_d, PANDA_RATE_LIMITS, strict=True
        ):
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
        limits.acceleration * PERIOD for limits in PANDA_RATE_LIMITS
    ])


def test_without_limits_only_the_low_pass_acts() -> None:
    command_filter, state = make(cutoff_frequency=100.0, rate_limiting=False)
    for values in (
        command_filter.torques([1.0] * 7, state),
        command_filter.velocities([1.0] * 7, state),
        command_filter.positions([1.0] * 7, state, goals=[1.0] * 7),
    ):
        assert values == pytest.approx([0.3859] * 7, abs=5e-5)
