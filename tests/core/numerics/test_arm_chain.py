"""Poses and Jacobians of chains against pinocchio, and both modes."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, strategies as st

from station.core.numerics import arm_chain
from station.memory.doubles import doubles, zeros
from tests.both_modes import arrays, assert_same, needs_both

IDENTITY = np.eye(4).ravel().tolist()
chains = st.lists(
    st.tuples(*[st.floats(-0.5, 0.5)] * 2, st.floats(-2.0, 2.0)), min_size=2, max_size=8
)


def chain_of(parameters):
    """Return a chain of a, d and alpha of the joints and the flange."""
    return doubles([
        value
        for a, d, alpha in parameters
        for value in (a, d, np.cos(alpha), np.sin(alpha))
    ])


def links_of(chain, q):
    links = doubles(IDENTITY * (len(chain) // 4))
    arm_chain.place_links(chain, doubles(q), links)
    return links


def truth_of(parameters):
    """Return pinocchio's model of the chain; its last frame is the flange."""
    model = pin.Model()
    joint = 0
    for number, (a, d, alpha) in enumerate(parameters):
        turn = pin.exp3(np.array([alpha, 0.0, 0.0]))
        place = pin.SE3(turn, turn @ [0.0, 0.0, d] + [a, 0.0, 0.0])
        if number + 1 < len(parameters):
            joint = model.addJoint(joint, pin.JointModelRZ(), place, f"joint{number}")
        else:
            frame = pin.Frame("flange", joint, place, pin.FrameType.OP_FRAME)
            model.addFrame(frame)
    return model


def positions(parameters):
    return [0.3 + 0.7 * joint * (-1) ** joint for joint in range(len(parameters) - 1)]


@given(chains)
def test_poses_and_jacobian_are_those_of_pinocchio(parameters):
    q, chain, model = positions(parameters), chain_of(parameters), truth_of(parameters)
    links, jacobian = links_of(chain, q), zeros(6 * len(q))
    flange = links[-16:]
    arm_chain.zero_jacobian(links, flange, jacobian)
    data, frame = model.createData(), model.nframes - 1
    axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    wanted = pin.computeFrameJacobian(model, data, np.array(q), frame, axes)
    pin.framesForwardKinematics(model, data, np.array(q))

    found = np.reshape(links, (-1, 4, 4)).transpose(0, 2, 1)
    for link, pose in enumerate([*data.oMi.tolist()[1:], data.oMf[frame]]):
        assert found[link] == pytest.approx(pose.homogeneous, abs=1e-12)
    columns = np.reshape(wanted, (6, -1)).T
    assert np.reshape(jacobian, (-1, 6)) == pytest.approx(columns, abs=1e-12)


def test_joints_behind_a_link_do_not_move_the_link():
    parameters = [(0.1, 0.2, 0.3)] * 4
    chain = chain_of(parameters)
    links, jacobian = links_of(chain, [0.1, 0.2, 0.3]), doubles([1.0] * 18)
    arm_chain.zero_jacobian(links, links[16:32], jacobian[:12])

    assert jacobian[12:].tolist() == [1.0] * 6
    assert jacobian[6:9].tolist() == pytest.approx([0.0] * 3)
    assert max(map(abs, jacobian[:3])) > 0.01


@given(arrays(6), st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3))
def test_axes_turn_there_and_back(vectors, turn):
    pose = doubles(IDENTITY)
    pose[:3], pose[4:7], pose[8:11] = (
        doubles(column) for column in pin.exp3(np.array(turn)).T.tolist()
    )
    vectors = doubles([max(-9.0, min(9.0, value)) for value in vectors])
    inside, outside = zeros(6), zeros(6)
    arm_chain.turn_to_inner_axes(pose, vectors, inside)
    arm_chain.turn_to_outer_axes(pose, inside, outside)

    assert outside.tolist() == pytest.approx(vectors.tolist(), abs=1e-12, nan_ok=True)


def test_twist_and_torques_are_products_with_the_jacobian():
    rng = np.random.default_rng(4)
    jacobian, rates, wrench = (
        rng.normal(size=42),
        rng.normal(size=7),
        rng.normal(size=6),
    )
    twist, torques = zeros(6), zeros(7)
    arm_chain.twist_of(doubles(jacobian), doubles(rates), twist)
    arm_chain.torques_of(doubles(jacobian), doubles(wrench), torques)

    matrix = jacobian.reshape(7, 6).T
    assert twist.tolist() == pytest.approx((matrix @ rates).tolist())
    assert torques.tolist() == pytest.approx((matrix.T @ wrench).tolist())


@given(chains, st.lists(st.floats(-0.3, 0.3), min_size=6, max_size=6))
def test_accelerometers_are_pinocchios_frames(parameters, placement):
    q, chain, model = positions(parameters), chain_of(parameters), truth_of(parameters)
    turn, place = pin.exp3(10.0 * np.array(placement[:3])), np.array(placement[3:])
    sensor, dq = pin.SE3(turn, place), [2.0 * value for value in q]
    ddq, gravity = [5.0 - 3.0 * value for value in q], [1.0, -2.0, -9.81]
    for joint in range(len(q) + 1):
        frame = pin.Frame(f"sensor{joint}", joint, sensor, pin.FrameType.SENSOR)
        model.addFrame(frame)
    data, model.gravity.linear = model.createData(), np.array(gravity)
    pin.forwardKinematics(model, data, *map(np.array, (q, dq, ddq)))
    pin.updateFramePlacements(model, data)

    sensors = doubles(sensor.homogeneous.T.ravel().tolist() * (len(q) + 1))
    found = zeros(3 * (len(q) + 1))
    motion = links_of(chain, q), doubles(dq), doubles(ddq), doubles(gravity)
    arm_chain.measure_accelerations(*motion, sensors, found)
    for joint in range(len(q) + 1):
        frame = model.getFrameId(f"sensor{joint}")
        local = pin.ReferenceFrame.LOCAL
        moved = pin.getFrameClassicalAcceleration(model, data, frame, local).linear
        expected = moved - data.oMf[frame].rotation.T @ gravity
        assert found[3 * joint : 3 * joint + 3].tolist() == pytest.approx(
            expected.tolist(), abs=1e-9
        )


@needs_both
@given(arrays(32), arrays(7), arrays(16), arrays(6))
def test_both_modes_agree_bit_for_bit(chain, q, pose, vectors):
    def scenario(module):
        links, jacobian, body = doubles(IDENTITY * 8), zeros(42), zeros(42)
        twist, torques, there = zeros(6), zeros(7), zeros(6)
        module.place_links(doubles(chain), doubles(q), links)
        module.zero_jacobian(links, doubles(pose), jacobian)
        module.turn_to_inner_axes(doubles(pose), jacobian, body)
        module.turn_to_outer_axes(links[:16], doubles(vectors), there)
        module.twist_of(jacobian, doubles(q), twist)
        module.torques_of(jacobian, doubles(vectors), torques)
        motion, felt = (doubles(q), doubles(q[::-1]), doubles(vectors[:3])), zeros(24)
        module.measure_accelerations(links, *motion, links, felt)
        return [*links, *jacobian, *body, *twist, *torques, *there, *felt]

    assert_same("arm_chain", scenario)
