"""Torques around a circle that the arm's own kinematics turns into joint motion."""

from math import hypot

import numpy as np
import pytest

from station.core.control.switching import SwitchRequest
from station.core.errors import ParameterError
from station.core.franka import Frame
from station.core.franka.arms import Arms
from station.hw.franka.arm.control_mode import ControlMode
from tests.controllers.franka_example_controllers.example_station import (
    run_without_errors,
    start_example,
)

K = [600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0]
D = [50.0, 50.0, 50.0, 20.0, 20.0, 20.0, 10.0]
PARAMS = {"k_gains": K, "d_gains": D, "vel_max": 0.15, "publish_rate": 10.0}


def test_it_moves_the_arm_by_pose_and_torque_at_once():
    station = start_example("JointImpedance", PARAMS)
    station.loop.step(10)

    mode = station.loop.hw.control_mode
    assert mode == ControlMode.CARTESIAN_POSE | ControlMode.JOINT_TORQUE
    assert station.latest().mode == "move"


def test_torques_follow_the_formula():
    station = start_example("JointImpedance", {**PARAMS, "coriolis_factor": 0.5})
    filtered, worst = np.zeros(7), 0.0
    # The controller's first cycle has run; the filter's part of it is 1 % by now.
    for cycle in range(300):
        station.loop.step()
        state = Arms(station.robots).state("panda")
        filtered = 0.01 * filtered + 0.99 * np.array(state.dq)
        if cycle < 3:
            continue
        model = Arms(station.robots).model("panda", Frame.FLANGE)
        tau = np.array(K) * np.subtract(state.q_d, state.q)
        tau += np.array(D) * (np.array(state.dq_d) - filtered)
        tau += 0.5 * np.array(model.coriolis)
        away = np.abs(tau - station.loop.hw.commands.efforts).max()
        worst = max(worst, away)
        assert np.abs(tau).max() < 1.0  # so that the rate limit does not act

    assert worst < 1e-6


@pytest.mark.slow
def test_circle_is_drawn_within_a_millimetre():
    station = start_example("JointImpedance", PARAMS)
    x, y, z = Arms(station.robots).state("panda").O_T_EE[12:15]

    # 2 s to full speed and 0.15 m, then 0.478 m at 0.15 m/s: once around.
    for _ in range(52):
        run_without_errors(station, 0.1)
        at = Arms(station.robots).state("panda").O_T_EE[12:15]
        # The test's stiffness is a fifth of the arm's own: it sags by its friction.
        assert hypot(at[1] - y - 0.1, at[2] - z) == pytest.approx(0.1, abs=1e-3)
        assert at[0] == pytest.approx(x, abs=1e-3)

    assert not any(Arms(station.robots).state("panda").last_motion_errors)
    told = station.published("example")["torque_comparison"]
    assert np.abs(told["tau_error"]).max() < 0.3
    assert told["root_mean_square_error"] == pytest.approx(
        np.abs(told["tau_error"]).mean()
    )


def test_restart_begins_a_new_circle():
    station = start_example("JointImpedance", PARAMS)
    station.loop.step(500)
    station.switch_controllers(SwitchRequest((), ("example",)))
    station.loop.step(300)
    before = Arms(station.robots).state("panda").O_T_EE[12:15]
    result = station.switch_controllers(SwitchRequest(("example",), ()))
    station.loop.step(50)

    assert max(result.jump.values()) < 1e-6
    after = Arms(station.robots).state("panda").O_T_EE[12:15]
    assert after == pytest.approx(before, abs=1e-3)


def test_gains_must_be_seven_and_time_not_zero():
    with pytest.raises(ParameterError, match="k_gains"):
        start_example("JointImpedance", {**PARAMS, "k_gains": [1.0]})
    with pytest.raises(ParameterError, match="acceleration_time"):
        start_example("JointImpedance", {**PARAMS, "acceleration_time": 0.0})
