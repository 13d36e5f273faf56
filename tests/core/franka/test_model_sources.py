"""What follows from an arm's state, against the arm's own functions; both modes."""

from types import SimpleNamespace

import pytest
from hypothesis import given, strategies as st

from station.core.description.robot_files import load_robot_files
from station.core.franka import Frame
from station.core.franka.franka_robot_state import RobotState
from station.core.franka.model_sources import ToolJacobianSource, ToolPoseSource
from station.core.numerics.arm_chain import new_links
from station.core.numerics.arm_dynamics import ArmDynamics
from station.hw.franka.arm.franka_kinematics import CHAIN, frame_pose, zero_jacobian
from station.hw.franka.simulated.arm_model import ArmModel
from station.memory.doubles import doubles, put, zeros
from tests.both_modes import arrays, assert_same, needs_both, sibling

Q = [0.1, -0.7, 0.2, -2.0, 0.3, 1.4, 0.6]
DQ = [0.3, -0.2, 0.5, 0.4, -0.6, 0.2, 0.1]
TOOL = [0.0, 1.0, 0, 0, -1.0, 0.0, 0, 0, 0, 0, 1.0, 0, 0.01, 0.02, 0.1, 1.0]


def test_pose_and_jacobian_of_a_tool_are_those_of_the_chain():
    links, q = new_links(CHAIN), doubles(Q)
    dynamics = ArmDynamics(CHAIN, zeros(70), links)
    source = ToolPoseSource(dynamics, q, links, doubles(TOOL))
    jacobian_source = ToolJacobianSource(source)
    pose, jacobian = zeros(16), zeros(42)
    for _ in range(2):
        source.write(pose)
        jacobian_source.write(jacobian)
        expected = frame_pose(Frame.END_EFFECTOR, [*q], TOOL)
        assert [*pose] == pytest.approx(expected, abs=1e-12)
        expected = zero_jacobian(Frame.END_EFFECTOR, [*q], TOOL)
        assert [*jacobian] == pytest.approx(expected, abs=1e-12)
        q[3] += 0.1


@pytest.fixture(scope="module")
def model():
    return ArmModel(load_robot_files("example-robot-data:panda"))


def coriolis(model, state):
    arrays = (state.q, state.dq, state.I_total)
    return model.coriolis(*arrays, state.m_total, state.F_x_Ctotal)


def test_coriolis_torques_follow_the_state_and_what_the_arm_carries(model):
    state = RobotState(q=Q, dq=DQ)
    source, found = model.coriolis_source(state), zeros(7)

    def check():
        source.write(found)
        assert [*found] == coriolis(
            ArmModel(load_robot_files("example-robot-data:panda")), state
        )

    check()
    state.m_total = 2.0
    check()
    state.F_x_Ctotal = [0.0, 0.1, 0.05]
    check()
    state.I_total = [0.02, 0, 0, 0, 0.03, 0, 0, 0, 0.01]
    check()
    state.q = [0.5, *Q[1:]]
    check()


def test_somebody_else_may_ask_the_model_for_another_load_in_between(model):
    state = RobotState(q=Q, dq=DQ, m_total=1.0, F_x_Ctotal=[0.0, 0.0, 0.1])
    source, first, second = model.coriolis_source(state), zeros(7), zeros(7)
    source.write(first)
    model.coriolis(Q, DQ, [0.0] * 9, 3.0, [0.2, 0.0, 0.0])
    source.write(second)
    assert [*second] == [*first]


@needs_both
@given(
    st.lists(st.tuples(arrays(7), arrays(7)), min_size=1, max_size=4),
    arrays(16),
    arrays(70),
)
def test_both_modes_agree_bit_for_bit(cycles, tool, bodies):
    def scenario(module):
        dynamics = sibling(module, "arm_dynamics")
        links, q, dq = new_links(CHAIN), zeros(7), zeros(7)
        arm = dynamics.ArmDynamics(CHAIN, doubles(bodies), links)
        pose_source = module.ToolPoseSource(arm, q, links, doubles(tool))
        center, inertia, state = zeros(3), zeros(9), SimpleNamespace(m_total=0.0)
        sources = (
            module.ToolJacobianSource(pose_source),
            module.CoriolisSource(
                arm, state, q, dq, center, inertia, arm.change_bodies
            ),
        )
        results, found = (zeros(42), zeros(7)), []
        for joints, rates in cycles:
            # Python's sine refuses infinity; no arm is there.
            put(q, [v if abs(v) < 1e3 else 0.0 for v in joints])
            put(dq, rates)
            center[0] += 1.0
            for source, result in zip(sources, results, strict=True):
                source.write(result)
                found += [*result]
            found.append(arm.changes)
        return found

    assert_same("model_sources", scenario)
