"""Filter and rate limits of commands: the same bits in both modes."""

from hypothesis import given, settings, strategies as st

from station.memory.doubles import doubles, put, zeros
from tests.both_modes import arrays, assert_same, needs_both

SIZE = 3
STATE = ("tau_J_d", "q_d", "dq_d", "ddq_d")


@needs_both
@settings(max_examples=60, deadline=None)
@given(
    gain=st.sampled_from([0.386, 1.0]),
    limits=st.booleans(),
    passes=st.booleans(),
    state=st.lists(arrays(SIZE), min_size=4, max_size=4),
    commands=st.lists(arrays(SIZE), min_size=1, max_size=3),
)
def test_both_modes_give_the_same_bits(gain, limits, passes, state, commands):
    def scenario(module):
        memory = {
            name: doubles(values) for name, values in zip(STATE, state, strict=True)
        }
        command = zeros(SIZE)
        rates = module.CommandRates(
            **memory,
            positions=command,
            velocities=command,
            efforts=command,
            velocity=[2.0, 1.0, 0.5],
            acceleration=[10.0, 5.0, 20.0],
            jerk=[5000.0, 3000.0, 9000.0],
            torque_rate=999.0,
            lower=[-1.0] * SIZE,
            upper=[1.5] * SIZE,
            braking_share=0.5,
            approach_gain=50.0,
            period=0.001,
        )
        rates.gain, rates.is_limiting = gain, limits
        found = []
        for values in commands:
            put(command, values)
            rates.note_goals()
            for method in (rates.filter_torques, rates.filter_velocities):
                method()
                found += rates.result
            rates.passes_next = passes
            rates.filter_positions()
            found += rates.result
        return found

    assert_same("command_rates", scenario)


@needs_both
@given(arrays(8))
def test_limited_velocity_has_the_same_bits(values):
    v, last, acceleration, a, j, low, high, _ = values

    def scenario(module):
        limits = (abs(a) + 1.0, abs(j) + 1.0, low, high, 0.001)
        return [module.limited(v, last, acceleration, *limits)]

    assert_same("command_rates", scenario)
