"""A trace survives the way through a file."""

from station.trials.trace import Trace


def test_trace_comes_back_from_its_bytes(world, step):
    trace = world.record(step)[1]

    again = Trace.from_bytes(trace.to_bytes())

    assert again.joints == trace.joints
    assert again.period == trace.period
    assert again.position.tobytes() == trace.position.tobytes()
    assert trace.position.shape == (150, 7)
