"""The spring's torques are those of its formula."""

import numpy as np
import pytest

from station.core.franka import Frame
from station.core.franka.arms import Arms
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
