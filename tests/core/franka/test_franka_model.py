"""A model handle passes on the present state."""

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.franka import Frame, FrankaModelHandle, RobotState
from station.hw.franka.simulated.arm_model import ArmModel

Q = [0.1, -0.5, 0.2, -2.0, 0.3, 1.5, 0.4]


@pytest.fixture
def handle():
    state = RobotState(q=list(Q), dq=[0.2] * 7, m_total=0.7, F_x_Ctotal=[0, 0, 0.05])
    model = ArmModel(load_robot_files("example-robot-data:panda"))
    return FrankaModelHandle("panda_model", model, state)


def test_state_form_is_the_explicit_form_with_the_state(handle):
    model, load = handle.model, ([0.0] * 9, 0.7, [0, 0, 0.05])
    identity = RobotState().F_T_EE

    assert handle.get_mass() == model.mass(Q, *load)
    assert handle.get_coriolis() == model.coriolis(Q, [0.2] * 7, *load)
    assert handle.get_gravity() == model.gravity(Q, *load[1:])
    for frame in Frame:
        frames = (frame, Q, identity, identity)
        assert handle.get_pose(frame) == model.pose(*frames)
        assert handle.get_zero_jacobian(frame) == model.zero_jacobian(*frames)
        assert handle.get_body_jacobian(frame) == model.body_jacobian(*frames)


def test_gravity_may_point_anywhere(handle):
    assert handle.get_gravity((0.0, 0.0, 0.0)) == pytest.approx([0.0] * 7)


def test_frames_have_libfrankas_numbers():
    assert [frame.value for frame in Frame] == list(range(10))
    assert Frame.STIFFNESS.value == 9
