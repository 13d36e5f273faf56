"""Numbers of poses that do not jump, and both modes."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from station.controllers.cartesian_motion.end_effector_sample import (
    PoseSample,
    TwistSample,
)
from station.core.franka.model_sources import ModelSource
from station.hw.franka.arm.franka_kinematics import CHAIN
from station.memory.doubles import doubles, put, zeros
from tests.both_modes import arrays, assert_same, needs_both, sibling

HERE = [1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0, 0.3, 0.0, 0.5, 1.0]
Q = [0.1, -0.7, 0.2, -2.0, 0.3, 1.4, 0.6]
TOOL = [0.0, 1.0, 0, 0, -1.0, 0.0, 0, 0, 0, 0, 1.0, 0, 0.01, 0.02, 0.1, 1.0]


def turned(angle):
    """Return a pose that is turned about z."""
    c, s = np.cos(angle), np.sin(angle)
    return [c, s, 0.0, 0.0, -s, c, 0.0, 0.0, *HERE[8:]]


def test_desired_measured_and_their_difference_are_kept():
    desired, measured = doubles(turned(0.2)), doubles(turned(0.0))
    sample = PoseSample(desired, ModelSource(lambda result: put(result, measured)))
    sample.keep(1.5)

    wanted = [0.3, 0.0, 0.5, 0.0, 0.0, np.sin(0.1), np.cos(0.1)]
    here = [0.3, 0.0, 0.5, 0.0, 0.0, 0.0, 1.0]
    time, packed, size = sample.sampled.newest
    columns = np.frombuffer(packed).reshape(4, size)
    assert time == 1.5
    assert columns[0] == pytest.approx(wanted)
    assert columns[1] == pytest.approx(here)
    assert columns[2] == pytest.approx(np.subtract(wanted, here))


def test_quaternions_do_not_jump_over_a_whole_turn():
    pose = zeros(16)
    sample = PoseSample(pose, ModelSource(lambda result: put(result, pose)))
    last = None
    for angle in np.linspace(0.0, 4.0 * np.pi, 200):
        put(pose, turned(angle))
        sample.keep(0.0)
        for now in ([*sample.desired], [*sample.actual]):
            assert last is None or np.abs(np.subtract(now, last)).max() < 0.05
        last = now


@pytest.mark.parametrize("is_inner", [False, True])
def test_twists_are_kept_in_the_axes_that_are_asked_for(is_inner):
    rng = np.random.default_rng(3)
    jacobian, dq = rng.normal(size=(6, 7)), rng.normal(size=7)
    wanted = rng.normal(size=6)
    sample = TwistSample(
        doubles(turned(0.3)),
        doubles(wanted),
        ModelSource(lambda result: put(result, turned(-0.4))),
        ModelSource(lambda result: put(result, jacobian.T.ravel())),
        doubles(dq),
    )
    sample.is_inner = is_inner
    sample.keep(1.0)

    def seen(angle, twist):
        axes = np.reshape(turned(angle), (4, 4))[:3, :3].T  # columns are the axes
        return np.concatenate([axes.T @ twist[:3], axes.T @ twist[3:]])

    actual = jacobian @ dq
    if is_inner:
        wanted, actual = seen(0.3, wanted), seen(-0.4, actual)
    _, packed, size = sample.sampled.newest
    columns = np.frombuffer(packed).reshape(4, size)
    assert columns[0] == pytest.approx(wanted)
    assert columns[1] == pytest.approx(actual)
    assert columns[2] == pytest.approx(wanted - actual)


@needs_both
@given(st.lists(st.tuples(arrays(16), arrays(7)), min_size=1, max_size=4), arrays(16))
def test_both_modes_agree_bit_for_bit(cycles, tool):
    def scenario(module):
        chain, dynamics = sibling(module, "arm_chain"), sibling(module, "arm_dynamics")
        links, q, pose = chain.new_links(CHAIN), zeros(7), zeros(16)
        arm = dynamics.ArmDynamics(CHAIN, zeros(70), links)
        source = sibling(module, "model_sources").ToolPoseSource(
            arm, q, links, doubles(tool)
        )
        sources = sibling(module, "model_sources")
        jacobian = sources.ToolJacobianSource(source)
        twist = zeros(6)
        samples = [
            module.PoseSample(pose, source),
            module.TwistSample(pose, twist, source, jacobian, q),
            module.TwistSample(pose, twist, source, jacobian, q),
        ]
        samples[2].is_inner = True
        found = []
        for values, joints in cycles:
            put(pose, values)
            # Python's sine refuses infinity; no arm is there.
            put(q, [v if abs(v) < 1e3 else 0.0 for v in joints])
            put(twist, values[:6])
            for sample in samples:
                sample.keep(0.0)
                found += [*sample.desired, *sample.actual, *sample.errors]
        return found

    assert_same("end_effector_sample", scenario)
