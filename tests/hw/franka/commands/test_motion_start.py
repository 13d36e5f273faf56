"""Cartesian motions and torques wait until the arm has come to rest."""

import pytest

from station.core.errors import SwitchRefusedError
from station.core.franka import (
    FrankaPoseCartesianInterface,
    FrankaServicesInterface,
    FrankaVelocityCartesianInterface,
    RobotMode,
)
from station.core.hardware.interfaces import VelocityJointInterface
from station.core.hardware.robot_hw import (
    ControllerInfo,
    InterfaceResources,
    SwitchState,
)
from station.hw.franka.arm.control_mode import ControlMode
from station.hw.franka.commands.motion_start import LONGEST_WAIT
from tests.hw.franka import test_franka_hw
from tests.hw.franka.test_franka_hw import drive, make, run

CARTESIAN = {
    "cp": FrankaPoseCartesianInterface,
    "cv": FrankaVelocityCartesianInterface,
}


def controllers(kind):
    """Return one controller that commands a kind of motion."""
    if kind not in CARTESIAN:
        return test_franka_hw.controllers(kind)
    claims = InterfaceResources(CARTESIAN[kind].type_name, ("panda_robot",))
    return [ControllerInfo(kind, "test/Controller", (claims,))]


@pytest.fixture
def hw():
    """Return an arm that moves by joint velocities."""
    hw = make()
    hw.do_switch(controllers("jv"), [])
    drive(hw, VelocityJointInterface, [0.3] * 7, 200)
    assert max(hw.robot_state.dq) > 0.2
    return hw


def test_switch_is_ongoing_until_the_arm_rests(hw):
    hw.do_switch(controllers("cp"), controllers("jv"))

    assert hw.switch_result() is SwitchState.ONGOING
    assert not hw.is_interrupted()
    for _ in range(300):
        run(hw, 1)
        if hw.switch_result() is SwitchState.DONE:
            break
    state = hw.robot_state
    assert hw.control_mode is ControlMode.CARTESIAN_POSE
    assert state.robot_mode is RobotMode.MOVE
    assert max(map(abs, state.dq)) < 1e-3
    assert max(map(abs, state.dq_d)) == 0.0


def test_joint_motion_takes_over_at_once(hw):
    hw.do_switch(controllers("jp"), controllers("jv"))

    assert hw.switch_result() is SwitchState.DONE
    assert hw.robot_state.robot_mode is RobotMode.MOVE


def test_torques_begin_where_the_arm_has_come_to_rest(hw):
    hw.do_switch(controllers("jt"), controllers("jv"))

    assert hw.switch_result() is SwitchState.ONGOING
    run(hw, LONGEST_WAIT)
    assert hw.switch_result() is SwitchState.DONE
    assert hw.robot_state.tau_J_d == [0.0] * 7
    assert max(map(abs, hw.robot_state.dq)) < 1e-3


def test_motion_that_goes_on_is_not_interrupted_to_add_torques(hw):
    with pytest.raises(SwitchRefusedError, match="interrupt its motion by joint_vel"):
        hw.prepare_switch(controllers("jt"), [])
    assert hw.robot_state.robot_mode is RobotMode.MOVE

    hw.prepare_switch(
        [*controllers("jt"), *controllers("jv")], controllers("jv")
    )  # begins anew


@pytest.mark.parametrize("realism", ["ideal", "typical"])
def test_torques_are_added_to_a_motion_that_rests(realism):
    hw = make(realism=realism)
    hw.do_switch(controllers("jv"), [])
    for _ in range(100):  # whatever the noise of the measured velocities
        drive(hw, VelocityJointInterface, [1e-6] * 7, 1)  # hardly moves
        hw.prepare_switch(controllers("jt"), [])
    hw.do_switch(controllers("jt"), [])
    run(hw, 10)

    assert hw.switch_result() is SwitchState.DONE
    assert hw.robot_state.robot_mode is RobotMode.MOVE


def test_same_mode_goes_on_for_joints_and_begins_anew_for_the_end_effector(hw):
    hw.do_switch(controllers("jv"), controllers("jv"))
    assert max(hw.robot_state.dq_d) > 0.2
    hw.do_switch(controllers("cv"), controllers("jv"))
    run(hw, LONGEST_WAIT)
    assert hw.switch_result() is SwitchState.DONE
    hw.do_switch(controllers("cv"), controllers("cv"))
    assert hw.switch_result() is SwitchState.DONE  # it rests


def test_arm_that_cannot_move_any_more_fails_the_switch(hw):
    hw.do_switch(controllers("cp"), controllers("jv"))
    arm = hw.get(FrankaServicesInterface).get_handle("panda")
    arm.simulation().set_user_stop(pressed=True)
    run(hw, 1)

    assert hw.switch_result() is SwitchState.ERROR


def test_arm_that_never_rests_is_not_waited_for_for_ever(hw, monkeypatch):
    monkeypatch.setattr(hw.arm, "is_at_rest", lambda: False)
    hw.do_switch(controllers("cp"), controllers("jv"))
    run(hw, LONGEST_WAIT)
    assert hw.switch_result() is SwitchState.ONGOING
    run(hw, 2)

    assert hw.switch_result() is SwitchState.DONE
