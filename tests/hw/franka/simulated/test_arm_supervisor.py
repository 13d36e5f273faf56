"""Measured values out of range are errors when they last."""

import pytest

from station.core.franka import ArmError, RobotState
from station.hw.franka.arm.arm_limits import PANDA_LIMITS, SupervisorLimits
from station.hw.franka.arm.franka_kinematics import CHAIN
from station.hw.franka.simulated.arm_parts import new_joint_memory
from station.hw.franka.simulated.arm_step import CycleLog
from station.hw.franka.simulated.arm_supervisor import ArmSupervisor
from station.hw.franka.simulated.joint_watch import JointWatch

Q = [0.0, -0.8, 0.0, -2.3, 0.0, 1.5, 0.8]


class Supervised:
    """A supervisor and the watch that notes violations for it."""

    def __init__(self, state: RobotState, **limits: float) -> None:
        thresholds = SupervisorLimits(**limits)
        memory, tool = new_joint_memory(state), state.doubles("F_T_EE")
        self.watch = JointWatch(
            memory, CHAIN, tool, PANDA_LIMITS, thresholds, 0.001, has_hand=False
        )
        log = CycleLog(state.motion(), 7)
        self.supervisor = ArmSupervisor(state, thresholds, self.watch, log)

    def errors(self, *, is_recovering: bool = False) -> list[ArmError]:
        is_following = False
        is_quiet = not self.watch.check_readings(is_following, has_moved=True)
        return self.supervisor.examine(
            is_quiet=is_quiet, is_following=is_following, is_recovering=is_recovering
        )


@pytest.mark.parametrize(
    ("q", "dq", "tau", "name"),
    [
        (3.0, 0.0, 0.0, "joint_position_limits_violation"),
        (0.0, 2.3, 0.0, "joint_velocity_violation"),
        (0.0, 0.0, 88.0, "tau_j_range_violation"),
    ],
)
def test_value_out_of_range_for_three_cycles_is_an_error(q, dq, tau, name):
    state = RobotState()
    supervised = Supervised(state)
    state.doubles("dtheta")[0], state.doubles("tau_J")[0] = dq, tau
    state.theta = [q, *Q[1:]]
    found = [supervised.errors() for _ in range(3)]
    assert found[:2] == [[], []]
    assert (found[2][0].name, found[2][0].where) == (name, "joint1")


def test_value_that_gets_worse_while_the_arm_recovers_is_accepted():
    state = RobotState()
    supervised = Supervised(state, debounce=1)
    state.theta = [*Q]
    torques = state.doubles("tau_J")
    for torque in (88.0, 99.0, 110.0):
        torques[0] = torque
        assert supervised.errors(is_recovering=True) == []
    assert supervised.errors() == []
    torques[0] = 120.0
    (error,) = supervised.errors()
    assert (error.name, error.value) == ("tau_j_range_violation", 120.0)


def test_fast_end_effector_is_an_error():
    state = RobotState()
    supervised = Supervised(state, debounce=1)
    # The stretched arm swings about joints 2 and 4, each within its limit.
    state.dtheta = [2.1, 2.1, 0.0, -2.1, 0.0, 0.0, 0.0]
    state.theta = [0.0, 1.5, 0.0, -0.1, 0.0, 1.6, 0.0]
    found = supervised.errors()
    assert [error.name for error in found] == ["cartesian_velocity_violation"]


def test_power_is_off_unless_limited():
    state = RobotState()
    state.doubles("dtheta")[0], state.doubles("tau_J")[0] = 2.0, 50.0
    state.theta = Q
    assert Supervised(state, debounce=1).errors() == []
    (error,) = Supervised(state, debounce=1, power=90.0).errors()
    assert (error.name, error.value) == ("power_limit_violation", 100.0)


def test_errors_of_the_last_motion_are_kept_when_the_present_errors_are_cleared():
    state = RobotState()
    supervisor = Supervised(state).supervisor
    supervisor._cycle_log.note(0.0)
    supervisor.set_errors([ArmError("joint_reflex", "joint1", 30, 20, "Nm")], 5)
    supervisor.set_errors([ArmError("joint_reflex", "joint1", 40, 20, "Nm")], 6)
    supervisor.end_motion()
    supervisor.clear()
    assert supervisor.errors == []
    assert [error.cycle for error in supervisor.last_motion_errors] == [5]
    assert state.last_motion_errors[6]
    assert not any(state.current_errors)
    assert len(supervisor.log) == 1
