"""The spring's torques are those of its formula."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from station.controllers.franka_arm.cartesian_spring import PoseSpring
from station.core.franka import Frame
from station.core.franka.arms import Arms
from station.memory.doubles import doubles, put
from tests.both_modes import arrays, assert_same, needs_both, numbers
from tests.controllers.franka_example_controllers.example_station import start_example


def torques(model, state, spring, rest):
    """Return the torques by the formula, with the inverse in closed form.

    `spring` is (position error, rotation error, translational, rotational and
    null space stiffness).
    """
    moved, turned, k, r, n = spring
    q, dq = np.array(state.q), np.array(state.dq)
    jacobian = np.reshape(model.zero_jacobian, (7, 6)).T
    stiffness = np.diag([k, k, k, r, r, r])
    damping = 2.0 * np.sqrt(stiffness)
    task = jacobian.T @ (
        -stiffness @ np.concatenate([moved, turned]) - damping @ jacobian @ dq
    )
    inverse = np.linalg.solve(jacobian @ jacobian.T + 0.04 * np.eye(6), jacobian)
    projector = np.eye(7) - jacobian.T @ inverse
    return task + projector @ (n * (rest - q) - 2 * np.sqrt(n) * dq) + model.coriolis


@pytest.mark.slow
def test_torques_follow_the_formula_when_the_spring_is_deflected():
    station = start_example("CartesianImpedance")
    rest = np.array(Arms(station.robots).state("panda").q)
    pose = Arms(station.robots).state("panda").O_T_EE
    station.loop.step(5)
    station.tuning.set_gains("example", {"nullspace_stiffness": 20.0})
    Arms(station.robots).apply_force(
        "panda", "panda_hand", [5.0, 4.0, 0], [0, 0.5, 0], 10
    )
    station.loop.step(3_000)  # all filters have settled

    state, model = (
        Arms(station.robots).state("panda"),
        Arms(station.robots).model("panda", Frame.END_EFFECTOR),
    )
    now, then = (np.reshape(p, (4, 4)).T for p in (state.O_T_EE, pose))
    turn = then[:3, :3] @ now[:3, :3].T
    angle = np.arccos((np.trace(turn) - 1) / 2)
    axis = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], 0.0])
    axis[2] = turn[1, 0] - turn[0, 1]
    axis /= np.linalg.norm(axis)
    turned = -np.sin(angle / 2) * axis  # the vector part of a quaternion
    spring = (now[:3, 3] - then[:3, 3], turned, 200.0, 10.0, 20.0)

    assert angle > 0.01
    commanded = [*station.loop.hw.commands.efforts]
    assert commanded == pytest.approx(torques(model, state, spring, rest), abs=1e-4)


def test_spring_begins_without_force():
    station = start_example("CartesianImpedance")
    pose = Arms(station.robots).state("panda").O_T_EE
    station.motion.set_command(
        "example", [pose[12] + 0.5, *pose[13:15], 0.0, 1.0, 0.0, 0.0]
    )
    station.loop.step(2)
    first = max(map(abs, station.loop.hw.commands.efforts))
    station.loop.step(50)

    assert first < 0.02
    assert max(map(abs, station.loop.hw.commands.efforts)) > 0.5


JOINTS = 7


def rotation(vector):
    """Return the rotation matrix of a rotation vector."""
    angle = np.linalg.norm(vector)
    x, y, z = np.asarray(vector) / angle
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * skew + (1 - np.cos(angle)) * skew @ skew


def quaternion(vector):
    """Return the quaternion x y z w of a rotation vector."""
    angle = np.linalg.norm(vector)
    return [*(np.sin(angle / 2) * np.asarray(vector) / angle), np.cos(angle / 2)]


def pose(position, matrix):
    result = np.eye(4)
    result[:3, :3], result[:3, 3] = matrix, position
    return result.T.ravel()


class Arm:
    """A spring, and the memory that it reads."""

    def __init__(self, *, is_angle=False, largest_step=np.inf):
        rng = np.random.default_rng(3)
        self.q, self.dq = rng.normal(size=JOINTS), 0.1 * rng.normal(size=JOINTS)
        self.jacobian = rng.normal(size=(6, JOINTS))
        self.coriolis = rng.normal(size=JOINTS)
        self._q, self._dq = doubles(self.q), doubles(self.dq)
        self.last = doubles([0.0] * JOINTS)
        self.spring = PoseSpring(self._q, self._dq, self.last, largest_step, is_angle)
        put(self.spring.pose, pose([0.3, 0.0, 0.5], np.eye(3)))
        put(self.spring.jacobian, self.jacobian.T.ravel())
        put(self.spring.coriolis, self.coriolis)

    def deflect(self, moved, turned, joints):
        put(self.spring.pose, pose(np.add([0.3, 0.0, 0.5], moved), rotation(turned)))
        self.q = self.q + joints
        put(self._q, self.q)

    def settle(self, *stiffness):
        """Let the filters of the stiffnesses end; the equilibrium stays."""
        put(self.spring.wanted, stiffness)
        for _ in range(20_000):
            self.spring.approach_targets()


@pytest.mark.parametrize("is_angle", [False, True])
def test_torques_are_those_of_the_formula(is_angle):
    arm = Arm(is_angle=is_angle)
    arm.spring.start_at_rest(0.0)
    arm.settle(200.0, 10.0, 20.0)
    moved, turned = np.array([0.02, -0.01, 0.03]), np.array([0.3, -0.2, 0.5])
    joints = np.linspace(-0.2, 0.3, JOINTS)
    arm.deflect(moved, turned, joints)
    arm.spring.compute_torques()

    angle = np.linalg.norm(turned)
    share = 1.0 if is_angle else np.sin(angle / 2) / angle
    stiffness = np.diag([200.0] * 3 + [10.0] * 3)
    jacobian, dq = arm.jacobian, arm.dq
    wrench = (
        -stiffness @ [*moved, *(share * turned)]
        - 2 * np.sqrt(stiffness) @ jacobian @ dq
    )
    u, s, vt = np.linalg.svd(jacobian.T, full_matrices=False)
    inverse = vt.T @ np.diag(s / (s * s + 0.2**2)) @ u.T
    stray = -20.0 * joints - 2 * np.sqrt(20.0) * dq
    expected = (
        jacobian.T @ wrench
        + (np.eye(JOINTS) - jacobian.T @ inverse) @ stray
        + arm.coriolis
    )
    assert list(arm.spring.torques) == pytest.approx(expected, rel=1e-9)


def test_a_torque_changes_by_the_largest_step_at_most():
    free, held = Arm(), Arm(largest_step=0.5)
    for arm in (free, held):
        put(arm.last, [0.1, -0.2, 0.3, 0.0, 5.0, -5.0, 0.0])
        arm.spring.start_at_rest(20.0)
        arm.deflect([0.0, 0.0, 0.1], [0.0, 0.1, 0.0], np.ones(JOINTS))
        arm.spring.compute_torques()

    wanted, last = np.array(free.spring.torques), np.array(held.last)
    assert np.abs(wanted - last).max() > 0.5
    expected = last + np.clip(wanted - last, -0.5, 0.5)
    assert list(held.spring.torques) == pytest.approx(expected)


def test_it_begins_without_force_where_the_arm_is():
    arm = Arm()
    arm.deflect([0.1, 0.2, 0.3], [0.1, 0.0, 0.2], np.zeros(JOINTS))
    arm.spring.start_at_rest(0.0)
    arm.spring.compute_torques()

    here = [0.4, 0.2, 0.8, *quaternion([0.1, 0.0, 0.2])]
    assert list(arm.spring.equilibrium) == pytest.approx(here)
    assert list(arm.spring.torques) == pytest.approx(list(arm.coriolis))


def test_stiffness_comes_in_the_time_of_the_filter():
    arm = Arm()
    arm.spring.start_at_rest(1.0)
    put(arm.spring.wanted, [100.0, 10.0, 0.0])
    for _ in range(200):
        arm.spring.approach_targets()

    left = 0.995**200
    expected = [100.0 * (1 - left), 10.0 * (1 - left), left]
    assert list(arm.spring.stiffness) == pytest.approx(expected)


@pytest.mark.parametrize("angle", [0.01, 1.5, 3.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_equilibrium_turns_evenly_the_short_way(angle, sign):
    arm = Arm()
    arm.spring.start_at_rest(0.0)
    turned = [sign * part for part in quaternion([0.0, angle, 0.0])]
    put(arm.spring.target, [0.3, 0.0, 0.7, *turned])
    arm.spring.approach_targets()

    found = list(arm.spring.equilibrium)
    assert found[:3] == pytest.approx([0.3, 0.0, 0.501])
    expected = quaternion([0.0, 0.005 * angle, 0.0])
    assert np.abs(np.dot(found[3:], expected)) == pytest.approx(1.0, abs=1e-12)


@needs_both
@given(arrays(49), arrays(26), arrays(7), st.booleans(), numbers)
def test_both_modes_agree_bit_for_bit(model, measured, target, is_angle, largest):
    def scenario(module):
        q, dq, last = measured[:5], measured[5:10], measured[:5]
        memory = [doubles(part) for part in (q, dq, last)]
        spring = module.PoseSpring(*memory, largest, is_angle)
        put(spring.pose, measured[10:])
        put(spring.jacobian, model[:30])
        put(spring.coriolis, model[30:35])
        put(spring.wanted, [abs(value) for value in model[35:38]])
        spring.start_at_rest(abs(model[38]))
        put(spring.pose, model[33:])
        put(spring.target, target)
        spring.compute_torques()
        spring.compute_torques()
        return [*spring.torques, *spring.equilibrium, *spring.stiffness]

    assert_same("cartesian_spring", scenario)
