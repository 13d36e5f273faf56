"""Sequences of PTP, LIN and CIRC, against Pinocchio and closed forms.

Pinocchio reads the same URDF with a parser of its own. The mock follows its commands
exactly, so that what is judged is what the controller wants in every cycle. 1e-6 m is
what 2 mm between the computed poses leaves of a line and of a circle, with room.
"""

from functools import cache

import numpy as np
import pinocchio as pin
import pytest

from station.controllers.joint_trajectory_controller.motion_primitives import (
    MotionPrimitive,
    MotionSequences,
)
from station.core.description.robot_description import (
    RobotDescription,
    chain_to,
    ends_of_chain,
)
from station.core.description.robot_files import load_robot_files
from station.core.description.urdf_parser import parse_urdf
from station.core.errors import (
    ControllerLoadError,
    ControllerStateError,
    InvalidTrajectoryError,
)
from station.core.ports.goal import GoalStatus
from tests.conformance.benches import JOINTS, POSE, robot_bench

KIND = "position_controllers/JointTrajectoryController"
EXACT = 1e-6
RADIUS = 0.05
MODEL = pin.buildModelFromXML(load_robot_files("example-robot-data:panda").xml)
TIP = MODEL.getFrameId("panda_hand_tcp")
TURNED = pin.Quaternion(pin.rpy.rpyToMatrix(np.pi, 0.2, 0.3))


def tip(q):
    data = MODEL.createData()
    pin.framesForwardKinematics(MODEL, data, np.concatenate([q, [0.0, 0.0]]))
    return data.oMf[TIP].copy()


HOME = tip(POSE)
DOWN = pin.Quaternion(HOME.rotation)


def pose(x, y, z, turn=DOWN, frame=""):
    """A pose away from that of `POSE`."""
    place = HOME.translation + np.array([x, y, z])
    return {
        "header": {"frame_id": frame},
        "pose": {"position": list(place), "orientation": turn.coeffs().tolist()},
    }


def lin(*place, blend=0.0, turn=DOWN, frame="", **arguments):
    return {
        "type": 50,
        "poses": [pose(*place, turn, frame)],
        "blend_radius": blend,
        "additional_arguments": [
            {"name": name, "value": value} for name, value in arguments.items()
        ],
    }


def ptp(q, blend=0.0, **arguments):
    message = {**lin(0, 0, 0, blend=blend, **arguments), "type": "LINEAR_JOINT"}
    del message["poses"]
    return {**message, "joint_positions": list(q)}


def circ(via, goal, **more):
    return {**lin(0, 0, 0, **more), "type": "CIRC", "poses": [pose(*goal), pose(*via)]}


def standing(**parameters):
    bench = robot_bench()
    jtc = bench.load_controller("jtc", KIND, joints=JOINTS, **parameters)
    bench.switch(["jtc"])
    bench.step(2)
    return bench, jtc


def follow(*motions):
    """Carry a sequence out; return q, dq and ddq of every cycle, shape (k, 7) each."""
    bench, jtc = standing()
    goal = jtc.goals.submit({"trajectory": {"motions": list(motions)}})
    rows, indices = [], []
    while not goal.is_final():
        bench.step()
        desired = jtc.trajectory_state.desired
        rows.append((desired.position, desired.velocity, desired.acceleration))
        indices.append(goal.feedback()["current_primitive_index"])
    assert goal.status is GoalStatus.SUCCEEDED
    assert bench.fault("jtc") is None
    return *np.array(rows).swapaxes(0, 1), indices


def places(q):
    return np.array([tip(row).translation for row in q]) - HOME.translation


def speeds(at):
    return np.linalg.norm(np.diff(at, axis=0), axis=1) / 0.001


@cache
def square_corner():
    """Two lines at a right angle with a blend, then an arc, then back by joints."""
    return follow(
        lin(0, 0.2, 0, blend=RADIUS),
        lin(0, 0.2, -0.2),
        circ(via=(0.06, 0.2, -0.14), goal=(0, 0.2, -0.08)),
        ptp(POSE),
    )


def test_lines_are_straight_and_keep_their_orientation():
    q, *_, index = square_corner()
    at = places(q)
    outside = np.linalg.norm(at - [0, 0.2, 0], axis=1) > RADIUS
    first = outside & (np.array(index) == 0)
    assert first.sum() > 500
    assert np.abs(at[first][:, [0, 2]]).max() < EXACT
    second = outside & (np.array(index) == 1)
    assert second.sum() > 300
    assert np.abs(at[second][:, 1] - 0.2).max() < EXACT
    for row in q[first | second][::50]:
        assert pin.log3(HOME.rotation.T @ tip(row).rotation) == pytest.approx(
            np.zeros(3), abs=EXACT
        )


def test_a_blend_is_within_its_radius_and_does_not_stop():
    q, *_ = square_corner()
    at = places(q)
    away = np.linalg.norm(at - [0, 0.2, 0], axis=1)
    inside = away < RADIUS
    # In the middle both lines count half, a quarter of the radius from the corner each.
    assert away.min() == pytest.approx(RADIUS * 2**0.5 / 4, abs=2e-4)
    assert np.abs(at[inside][:, 0]).max() < EXACT
    steps = speeds(at)[inside[1:]]
    assert steps.min() > 0.98 * steps.max() > 0.1


def test_an_arc_has_its_radius_and_passes_its_via_point():
    q, *_, index = square_corner()
    at = places(q)[np.array(index) == 2]
    # By hand: the via point is 0.06 m beside the middle of the chord of 0.12 m.
    centre = np.array([0, 0.2, -0.14])
    assert np.abs(np.linalg.norm(at - centre, axis=1) - 0.06).max() < EXACT
    assert np.linalg.norm(at - [0.06, 0.2, -0.14], axis=1).min() < 2e-4
    assert at[-1] == pytest.approx([0, 0.2, -0.08], abs=2e-4)


def test_speeds_are_those_of_the_defaults_and_the_index_goes_on():
    q, dq, _, index = square_corner()
    steps = speeds(places(q))[:-1]
    tip_moves = np.array(index[:-2]) < 3
    assert steps[: tip_moves.sum()].max() == pytest.approx(0.25, rel=2e-3)
    assert np.abs(dq[np.array(index) == 3]).max() <= 1.04 * (1 + 1e-6)
    assert sorted(set(index)) == [0, 1, 2, 3]
    assert index == sorted(index)
    assert q[-1] == pytest.approx(POSE, abs=1e-9)


def test_joints_keep_their_limits_however_fast_it_should_be():
    q, dq, ddq, _ = follow(
        ptp([0.5, *POSE[1:]], blend=0.05, velocity=50.0, acceleration=500.0),
        lin(0, 0.1, 0.1, blend=0.05, velocity=50.0, acceleration=500.0),
        lin(0.1, -0.1, 0.1, turn=TURNED, velocity=50.0, acceleration=500.0),
    )
    fastest = MODEL.velocityLimit[:7]
    assert (np.abs(dq) <= fastest).all()
    assert (np.abs(ddq) <= 2.02 * fastest).all()
    # One of them is used up.
    assert max((np.abs(dq) / fastest).max(), (np.abs(ddq) / fastest).max() / 2) > 0.9
    assert tip(q[-1]).rotation == pytest.approx(TURNED.matrix(), abs=EXACT)
    # The derivatives are those of the positions.
    assert dq[1:-1] == pytest.approx((q[2:] - q[:-2]) / 0.002, abs=1e-3)


def test_a_motion_of_joints_turns_into_a_line_at_the_radius():
    aside = [0.6, *POSE[1:]]
    corner = tip(aside).translation
    q, *_ = follow(
        ptp(aside, blend=0.08),
        lin(
            *(corner - HOME.translation + [0, 0, 0.2]),
            turn=pin.Quaternion(tip(aside).rotation),
        ),
    )
    away = np.linalg.norm(places(q) + HOME.translation - corner, axis=1)
    enters, leaves = np.flatnonzero(away < 0.08)[[0, -1]]
    # Before, only the first joint moves; afterwards the tip goes straight up.
    assert np.abs(q[:enters, 1:] - POSE[1:]).max() < 1e-9
    line = places(q[leaves + 2 :]) + HOME.translation - corner
    assert np.abs(line[:, :2]).max() < EXACT
    assert np.abs(q[enters + 5] - q[enters - 1])[1:].max() > 0.0


def test_arguments_bound_the_speed_and_a_time_is_kept():
    q, *_, index = follow(
        lin(0, 0.1, 0, velocity=0.05),
        lin(0, 0.1, 0.1, move_time=1.5),
        ptp(POSE, velocity=0.2, acceleration=0.5),
    )
    times = np.searchsorted(index, [0, 1, 2, 3]) * 0.001
    steps = speeds(places(q))
    assert steps[: int(times[1] * 1000) - 1].max() == pytest.approx(0.05, rel=2e-3)
    assert times[2] - times[1] == pytest.approx(1.5, abs=0.003)
    leading = np.abs(np.diff(q[int(times[2] * 1000) + 2 :], axis=0)).max() / 0.001
    assert leading == pytest.approx(0.2, rel=2e-3)


@pytest.mark.parametrize(
    ("motions", "index", "reason"),
    [
        ([lin(0, 0.1, 0), lin(0.9, 0.1, 0.3)], 1, "unreachable"),
        ([lin(0, 0, 0.1), ptp([3.5, *POSE[1:]])], 1, "limits"),
        ([lin(0, 0.1, 0, blend=0.2), lin(0, 0.1, 0.1)], 0, "blend"),
        ([lin(0, 0.1, 0, blend=0.06), lin(0, 0.1, 0.05)], 1, "blend"),
        (
            [
                lin(0, 0.1, 0, blend=0.06),
                lin(0, 0.1, 0.1, blend=0.06),
                lin(0, 0, 0.1),
            ],
            1,
            "blend",
        ),
        ([circ(via=(0, 0.1, 0), goal=(0, 0.2, 0))], 0, "circle"),
        ([lin(0, 0.2, 0, move_time=0.1)], 0, "pace"),
        ([ptp([0.0])], 0, "target"),
    ],
)
def test_a_primitive_that_cannot_be_followed_is_refused_by_index(
    motions, index, reason
):
    _, jtc = standing()
    with pytest.raises(InvalidTrajectoryError, match=f"Primitive {index}: ") as caught:
        jtc.goals.submit({"trajectory": {"motions": motions}})
    assert caught.value.details["primitive"] == index
    assert caught.value.details["reason"] == reason
    assert caught.value.details["error_code"] == -1
    assert jtc.goals.goals() == []


@pytest.mark.parametrize(
    ("motions", "words"),
    [
        ([], "1 to 200"),
        ([{"type": 7}], "motions/0/type' is 7"),
        ([lin(0, 0, 0), {**ptp(POSE), "joint_positions": []}], "motions/1'"),
        ([{**lin(0, 0, 0), "type": 51}], "2 poses"),
        ([lin(0, 0, 0, efficiency=1.0)], "'efficiency'"),
        ([lin(0, 0, 0, velocity=-1.0)], "motions/0/velocity' is -1.0"),
        ([lin(0, 0, 0.1, blend=0.1)], "motions/0/blend_radius"),
        ([lin(0, 0, 0, frame="moon")], "no link 'moon'"),
        ([lin(0, 0, 0, frame="panda_link0"), lin(0, 0, 0, frame="x")], "one frame"),
        ([lin(0, 0, 0, turn=pin.Quaternion(0.0, 0.0, 0.0, 0.0))], "not 0"),
    ],
)
def test_a_malformed_sequence_is_refused_by_its_field(motions, words):
    _, jtc = standing()
    with pytest.raises(InvalidTrajectoryError, match=words) as caught:
        jtc.goals.submit({"trajectory": {"motions": motions}})
    assert "FollowJointTrajectoryGoal" not in caught.value.remedy


def test_a_sequence_begins_at_rest_and_in_a_running_controller():
    bench, jtc = standing()
    motions = {"trajectory": {"motions": [lin(0, 0.1, 0, frame="panda_link0")]}}
    jtc.goals.submit(motions)
    bench.step(100)
    with pytest.raises(InvalidTrajectoryError, match="joints move"):
        jtc.goals.submit(motions)
    bench.switch(stop=["jtc"])
    with pytest.raises(ControllerStateError):
        jtc.goals.submit(motions)


def test_what_leads_nowhere_succeeds():
    q, *_ = follow(ptp(POSE), lin(0, 0, 0))
    assert q[-1] == pytest.approx(POSE, abs=1e-9)


def test_another_tip_may_be_named():
    bench, jtc = standing(kinematics={"tip": "panda_link8"})
    jtc.goals.submit({"trajectory": {"motions": [lin(0, 0.1, 0.1)]}})
    bench.step()
    data = MODEL.createData()
    end = [*jtc.trajectories.query_state(60.0).position, 0.0, 0.0]
    pin.framesForwardKinematics(MODEL, data, np.array(end))
    flange = data.oMf[MODEL.getFrameId("panda_link8")]
    assert flange.translation == pytest.approx(
        HOME.translation + np.array([0, 0.1, 0.1]), abs=EXACT
    )


def test_an_arm_of_six_joints_ends_at_tool0_and_keeps_away_from_its_singular_wrist():
    xml = load_robot_files("example-robot-data:ur5").xml
    urdf, described = parse_urdf(xml), RobotDescription(xml)
    names = [name for name, joint in urdf.joints.items() if joint.type.moves]
    assert ends_of_chain(urdf, names) == ("base_link", "tool0")
    with pytest.raises(ControllerLoadError, match="no chain"):
        ends_of_chain(urdf, [*names, "panda_joint1"])
    sequences = MotionSequences(
        [described.joint(name) for name in names],
        lambda _: chain_to(urdf, "base_link", "tool0", names),
    )
    model = pin.buildModelFromXML(xml)
    data, frame = model.createData(), model.getFrameId("tool0")

    def turn(wrist):
        start = np.array([0.0, -1.2, 1.6, -1.9, wrist, 0.0])
        pin.framesForwardKinematics(model, data, start)
        goal = data.oMf[frame].homogeneous.copy()
        goal[:3, :3] = pin.exp3(np.array([0.6, 0.0, 0.0])) @ goal[:3, :3]
        goal[1, 3] += 0.1
        motion = MotionPrimitive(50, 0.0, {}, [goal.T.ravel().tolist()], ())
        points, _ = sequences.plan([motion], "", start.tolist())
        pin.framesForwardKinematics(model, data, np.array(points[-1].positions))
        assert data.oMf[frame].homogeneous == pytest.approx(goal, abs=EXACT)

    turn(-0.6)
    # Its axes 4 and 6 are nearly parallel there.
    with pytest.raises(InvalidTrajectoryError, match="singular") as caught:
        turn(-0.02)
    assert caught.value.details["reason"] == "singular"
