"""A part of a recording is read as the test that it has in it."""

import numpy as np
import pytest

from station.trials.bench_analysis import excitation_of_part, joint_test
from station.trials.trace import Trace
from station.wire.excitations import PartRequest


def test_a_step_that_goes_back_is_read_until_it_goes_back():
    time = np.arange(3000) * 1e-3
    desired = np.where((time >= 0.5) & (time < 2.0), 0.3, 0.2)
    # A first-order answer: it rises from 10 to 90 % in ln(9) time constants.
    lag = np.exp(-np.maximum(time - 0.5, 0.0) / 0.1)
    position = np.where(time < 2.0, 0.3 - 0.1 * lag, 0.2)
    zeros = np.zeros((3000, 1))
    columns = [values[:, None] for values in (position, zeros[:, 0], zeros[:, 0])]
    trace = Trace(("j",), 1e-3, time, *columns, desired[:, None], zeros, zeros)
    part = PartRequest(controller="arm", joint="j", kind="step")

    excitation, script, chosen = excitation_of_part(part, trace)
    found = joint_test(chosen, excitation, script, {})

    assert excitation.amplitude == pytest.approx(0.1)
    assert found.metrics["rise_time"] == pytest.approx(0.1 * np.log(9.0), abs=0.002)
    assert found.metrics["overshoot"] == pytest.approx(0.0, abs=1e-3)
    assert found.proposals == []
