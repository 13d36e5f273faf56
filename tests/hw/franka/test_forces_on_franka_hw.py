"""FrankaHW feels what pushes its arm, and nothing when nothing does."""

from dataclasses import dataclass
from math import cos, sin

import numpy as np
import pytest

from station.core.franka import (
    FrankaServices,
    FrankaServicesInterface,
    FrankaStateInterface,
)
from station.core.franka.franka_robot_state import RobotState
from station.core.hardware.interfaces import PositionJointInterface
from station.hw.franka.franka_hw import FrankaHW
from station.hw.franka.franka_parameters import INITIAL_POSITIONS
from tests.hw.franka.test_franka_hw import drive, make, run, switch

NONE = [0.0, 0.0, 0.0]
JOINTS = [f"panda_joint{number}" for number in range(1, 8)]
# High above the floor, so that no pose touches it.
BASE = [0.0, 0.0, 2.0]
PAYLOAD = 1.3
WEIGHT = 9.81 * PAYLOAD
# 10 cm in front of the end effector, turned by 0.4 rad about x.
C, S = cos(0.4), sin(0.4)
EE_T_K = [1, 0, 0, 0, 0, C, S, 0, 0, -S, C, 0, 0.02, 0.03, 0.1, 1]
# After the filter of 100 Hz, and after the arm's swing into its deflected pose.
SETTLED = 500
TOO_CLOSE = "self_collision_avoidance_violation"


@dataclass(frozen=True)
class Push:
    """A force on the hand in some pose."""

    q: list[float]
    force: list[float]


@pytest.fixture(scope="module")
def hw() -> FrankaHW:
    return make(base_xyz=BASE)


@pytest.fixture
def services(hw: FrankaHW) -> FrankaServices:
    (services,) = hw.get(FrankaServicesInterface).handles()
    services.set_load(0.0, NONE, [0.0] * 9)
    services.set_K_frame([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])
    return services


def pushes(count: int) -> list[Push]:
    """Return random forces of 15 N in poses around the start pose, none singular."""
    generator = np.random.default_rng(17)
    result = []
    for _ in range(count):
        q = INITIAL_POSITIONS + generator.uniform(-0.4, 0.4, 7)
        force = generator.normal(size=3)
        force *= 15.0 / np.linalg.norm(force)
        result.append(Push(q.tolist(), force.tolist()))
    return result


def put(hw: FrankaHW, services: FrankaServices, q: list[float]) -> None:
    hw.simulated_world().reset(dict(zip(JOINTS, q, strict=True)))
    services.error_recovery()


def carry(hw: FrankaHW, services: FrankaServices, force: list[float]) -> None:
    """Load the hand with a weight that the arm knows of, and push it besides."""
    data = hw.simulated_world().world.data
    hand, link7 = data.body("panda_hand"), data.body("panda_link7")
    axes = np.reshape(link7.xmat, (3, 3))
    flange = link7.xpos + 0.107 * axes[:, 2]
    center = (axes.T @ (hand.xipos - flange)).tolist()
    services.set_load(PAYLOAD, center, [0.0] * 9)
    pull = [force[0], force[1], force[2] - WEIGHT]
    services.simulation().apply_force("panda_hand", pull, NONE, 60.0)


def read_state(hw: FrankaHW) -> RobotState:
    return hw.get(FrankaStateInterface).get_handle("panda_robot").get_robot_state()


def expected_wrench(hw: FrankaHW, force: list[float]) -> list[float]:
    """Return the reverse of a force on the hand's centre of mass, as felt at K."""
    state = read_state(hw)
    ee = np.reshape(state.O_T_EE, (4, 4)).T
    stiffness = ee @ np.reshape(state.EE_T_K, (4, 4)).T
    acts_at = hw.simulated_world().world.data.body("panda_hand").xipos - BASE
    torque = np.cross(acts_at - stiffness[:3, 3], force)
    return [-value for value in (*force, *torque)]


def assert_within_two_percent(felt: list[float], expected: list[float]) -> None:
    for part in (slice(0, 3), slice(3, 6)):
        # The torque is up to 3 Nm; where it vanishes 2 % of the force on 0.1 m count.
        size = max(float(np.linalg.norm(expected[part])), 1.5)
        assert felt[part] == pytest.approx(expected[part], abs=0.02 * size)


@pytest.mark.parametrize(
    "push",
    [
        *pushes(10)[:3],
        *(pytest.param(push, marks=pytest.mark.long) for push in pushes(10)[3:]),
    ],
)
@pytest.mark.parametrize("frame", [None, EE_T_K], ids=["EE", "K"])
@pytest.mark.parametrize("payload", [False, True], ids=["bare", "loaded"])
def test_push_of_the_hand_is_felt_with_opposite_sign(
    hw: FrankaHW, services: FrankaServices, push: Push, frame: list, *, payload: bool
) -> None:
    put(hw, services, push.q)
    if frame is not None:
        services.set_K_frame(frame)
    if payload:
        carry(hw, services, push.force)
    else:
        services.simulation().apply_force("panda_hand", push.force, NONE, 60.0)
    run(hw, SETTLED)
    state = read_state(hw)
    expected = expected_wrench(hw, push.force)
    assert_within_two_percent(state.O_F_ext_hat_K, expected)
    ee = np.reshape(state.O_T_EE, (4, 4)).T
    axes = (ee @ np.reshape(state.EE_T_K, (4, 4)).T)[:3, :3].T
    local = [*(axes @ expected[:3]), *(axes @ expected[3:])]
    assert_within_two_percent(state.K_F_ext_hat_K, local)
    assert not any(state.joint_collision + state.cartesian_collision)
    assert hw.mode() == "idle"


@pytest.mark.parametrize("push", pushes(3))
def test_push_is_felt_while_a_controller_holds_the_arm(
    hw: FrankaHW, services: FrankaServices, push: Push
) -> None:
    put(hw, services, push.q)
    switch(hw, "jp")
    try:
        services.simulation().apply_force("panda_hand", push.force, NONE, 60.0)
        drive(hw, PositionJointInterface, push.q, SETTLED)
        felt = read_state(hw).O_F_ext_hat_K
        assert_within_two_percent(felt, expected_wrench(hw, push.force))
        assert hw.mode() == "move"
    finally:
        switch(hw, "none", "jp")


def test_filter_lets_63_percent_of_a_force_through_in_its_time_constant(
    hw: FrankaHW, services: FrankaServices
) -> None:
    put(hw, services, list(INITIAL_POSITIONS))
    services.simulation().apply_force("panda_link4", [0.0, 10.0, 0.0], NONE, 1.0)
    torques = []
    for _ in range(60):
        run(hw, 1)
        torques.append(read_state(hw).tau_ext_hat_filtered[0])
    # 100 Hz: 1.6 ms; the first cycles take gains of 0.386, 0.623, 0.768.
    assert [torque / torques[-1] for torque in torques[:3]] == pytest.approx(
        [0.386, 0.623, 0.768], abs=0.01
    )


@pytest.mark.parametrize("payload", [False, True], ids=["bare", "loaded"])
def test_nothing_is_felt_at_rest_in_a_hundred_poses(
    hw: FrankaHW, services: FrankaServices, *, payload: bool
) -> None:
    generator = np.random.default_rng(23)
    limits = hw.parameters.limits
    low, high = np.array(limits.lower) + 0.1, np.array(limits.upper) - 0.1
    poses = 0
    while poses < 100:
        put(hw, services, generator.uniform(low, high).tolist())
        if hw.simulated_world().world.data.ncon:
            continue  # the arm touches itself there
        if payload:
            carry(hw, services, NONE)
        run(hw, 20)
        if {error.name for error in hw.arm.errors()} == {TOO_CLOSE}:
            continue  # or all but touches itself
        poses += 1
        state = read_state(hw)
        assert state.tau_ext_hat_filtered == pytest.approx([0.0] * 7, abs=1e-6)
        assert state.O_F_ext_hat_K == pytest.approx([0.0] * 6, abs=1e-5)
        assert not any(state.joint_contact + state.cartesian_contact)
        assert not any(state.joint_collision + state.cartesian_collision)
        assert hw.mode() == "idle"
