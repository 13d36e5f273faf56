"""Franka arms seen from outside: state, model, settings, buttons and faults."""

import pytest

from station.core.clock import ManualClock
from station.core.control.controller import ControllerState
from station.core.control.controller_loader import TableLoader
from station.core.control.controller_manager import ControllerManager
from station.core.control.switching import SwitchRequest
from station.core.errors import (
    ArmCommandError,
    ArmNotFoundError,
    InvalidCommandError,
    SwitchRefusedError,
)
from station.core.facade.station import Station
from station.core.franka import (
    FaultKind,
    Frame,
    FrankaServicesInterface,
    RobotMode,
    SimulatedFault,
)
from station.core.franka.arms import Arms
from station.core.loop.control_loop import ControlLoop
from station.core.parameters import Parameters
from tests.franka_station import JOINTS, make_franka_station
from tests.service_calls import call_service

HIT = SimulatedFault(FaultKind.COLLISION, 30)


@pytest.fixture
def station() -> Station:
    return make_franka_station()


@pytest.fixture
def moving(station: Station) -> Station:
    """Return a station whose controller `arm` runs."""
    station.switch_controllers(SwitchRequest(("arm",), ()))
    station.loop.step(100)
    return station


def test_station_without_arms_has_none():
    parameters, clock = Parameters(), ManualClock()
    from station.hw.mock import MockRobotHW

    hw = MockRobotHW()
    hw.init(parameters, parameters)
    manager = ControllerManager(hw, parameters, [TableLoader({})], clock)
    station = Station(ControlLoop(hw, manager, clock=clock), manager, parameters)

    assert Arms(station.robots).names() == []
    with pytest.raises(ArmNotFoundError, match="no arm 'panda'"):
        Arms(station.robots).state("panda")


def test_state_and_model_are_of_this_cycle(station):
    station.loop.step(10)

    state = Arms(station.robots).state("panda")
    model = Arms(station.robots).model("panda", Frame.END_EFFECTOR)

    assert state.time == pytest.approx(0.011)
    assert model.pose == pytest.approx(state.O_T_EE)
    assert model.pose[12:15] == pytest.approx([0.306891, 0.0, 0.486882], abs=1e-5)
    assert state.m_total == pytest.approx(0.76)
    # What holds the arm is what the sensors feel.
    assert model.gravity == pytest.approx(state.tau_J, abs=1e-3)
    assert len(model.mass) == 49
    assert len(model.zero_jacobian) == len(model.body_jacobian) == 42


def test_model_s_gravity_is_the_one_of_the_world():
    station = make_franka_station(gravity=[1.0, -2.0, -1.62])
    station.loop.step(1000)

    state = Arms(station.robots).state("panda")
    model = Arms(station.robots).model("panda", Frame.FLANGE)

    assert state.O_ddP_O == pytest.approx([1.0, -2.0, -1.62])
    assert abs(model.gravity[0]) > 0.5
    assert model.gravity == pytest.approx(state.tau_J, abs=0.02)


def test_settings_are_refused_while_the_arm_moves(moving):
    with pytest.raises(ArmCommandError, match="while a motion runs"):
        call_service(
            moving, "panda", "set_joint_impedance", joint_stiffness=[100.0] * 7
        )
    with pytest.raises(ArmCommandError, match="a controller commands"):
        call_service(moving, "panda", "disconnect")


IN_RANGE = [
    ("set_joint_impedance", {"joint_stiffness": [14250.0] * 7}),
    ("set_cartesian_impedance", {"cartesian_stiffness": [10.0] * 3 + [300.0] * 3}),
]
NO_INERTIA = {"F_x_center_load": [0.0] * 3, "load_inertia": [0.0] * 9}
OUT_OF_RANGE = [
    ("set_joint_impedance", {"joint_stiffness": [14251.0] * 7}, "joint_stiffness"),
    (
        "set_cartesian_impedance",
        {"cartesian_stiffness": [10.0] * 3 + [301.0] * 3},
        "cartesian_stiffness",
    ),
    ("set_EE_frame", {"NE_T_EE": [0.0] * 16}, "no transform"),
    ("set_load", {"mass": -1.0, **NO_INERTIA}, "load of -1"),
]


@pytest.mark.parametrize(("name", "arguments"), IN_RANGE)
def test_settings_at_the_end_of_their_range_are_taken(station, name, arguments):
    assert call_service(station, "panda", name, **arguments) is None


@pytest.mark.parametrize(("name", "arguments", "problem"), OUT_OF_RANGE)
def test_settings_out_of_range_are_refused(station, name, arguments, problem):
    with pytest.raises(InvalidCommandError, match=problem):
        call_service(station, "panda", name, **arguments)


def test_frames_and_load_show_in_the_state(station):
    shift = [1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0.1, 1.0]
    before = Arms(station.robots).state("panda")
    call_service(station, "panda", "set_EE_frame", NE_T_EE=shift)
    call_service(station, "panda", "set_K_frame", EE_T_K=shift)
    load = {"F_x_center_load": [0.01, -0.2, 0.03], "load_inertia": [0.0] * 9}
    call_service(station, "panda", "set_load", mass=0.5, **load)

    state = Arms(station.robots).state("panda")

    assert state.O_T_EE[14] == pytest.approx(before.O_T_EE[14] - 0.1)
    assert shift == state.EE_T_K
    assert state.m_total == pytest.approx(1.26)


def test_disconnected_arm_takes_no_controllers(station):
    call_service(station, "panda", "disconnect")
    with pytest.raises(SwitchRefusedError, match="not connected"):
        station.switch_controllers(SwitchRequest(("arm",), ()))
    with pytest.raises(ArmCommandError, match="not connected"):
        call_service(station, "panda", "disconnect")
    call_service(station, "panda", "connect")
    station.switch_controllers(SwitchRequest(("arm",), ()))
    with pytest.raises(ArmCommandError, match="connected already"):
        call_service(station, "panda", "connect")


def test_push_shows_in_the_wrench(station):
    Arms(station.robots).apply_force(
        "panda", "panda_hand", [0.0, 5.0, 0.0], [0.0, 0.0, 0.0], 1.0
    )
    station.loop.step(400)

    state = Arms(station.robots).state("panda")

    assert state.O_F_ext_hat_K[1] == pytest.approx(-5.0, rel=0.02)
    assert Arms(station.robots).log("panda") == []


def test_late_cycle_is_longer_and_counted_and_no_error(moving):
    moving.loop.reset_statistics()
    Arms(moving.robots).inject("panda", SimulatedFault(FaultKind.DELAYED_CYCLE, 10))
    before = Arms(moving.robots).state("panda").time
    moving.loop.step(5)

    state = Arms(moving.robots).state("panda")

    assert moving.loop.report().skipped == 10
    periods = [one.period for one in moving.snapshots.read_since(0)[0]][-5:]
    assert periods == pytest.approx([0.011, 0.001, 0.001, 0.001, 0.001])

    assert state.time == pytest.approx(before + 0.015)
    assert state.robot_mode is RobotMode.MOVE
    assert state.control_command_success_rate == pytest.approx(0.9)


def test_delay_of_twenty_cycles_stops_the_arm(moving):
    Arms(moving.robots).inject("panda", SimulatedFault(FaultKind.DELAYED_CYCLE, 20))
    moving.loop.step(2)

    (error,) = Arms(moving.robots).report("panda").errors

    assert error.name == "communication_constraints_violation"
    assert "communication_constraints_violation" in moving.controller("arm").fault


@pytest.mark.parametrize(
    "use",
    [
        lambda arms: arms.set_user_stop("panda", pressed=True),
        lambda arms: arms.set_guiding("panda", pressed=True),
        lambda arms: arms.apply_force("panda", "hand", [0.0] * 3, [0.0] * 3, 1.0),
        lambda arms: arms.inject("panda", HIT),
        lambda arms: arms.faults("panda"),
        lambda arms: arms.clear_faults("panda"),
    ],
)
def test_arm_that_is_not_simulated_refuses_what_only_simulations_can_do(
    station, monkeypatch, use
):
    arm = station.loop.hw.get(FrankaServicesInterface).get_handle("panda")
    monkeypatch.setattr(arm, "simulation", lambda: None)
    epoch = station.epoch

    with pytest.raises(ArmCommandError, match="Arm 'panda' is not simulated"):
        use(Arms(station.robots))
    assert station.epoch == epoch


def test_delay_of_seconds_is_refused(moving):
    with pytest.raises(InvalidCommandError, match="delayed cycle is 501"):
        Arms(moving.robots).inject(
            "panda", SimulatedFault(FaultKind.DELAYED_CYCLE, 501)
        )


def test_guided_arm_takes_no_controllers(station):
    Arms(station.robots).set_guiding("panda", pressed=True)
    with pytest.raises(SwitchRefusedError, match="mode guiding"):
        station.switch_controllers(SwitchRequest(("arm",), ()))
    Arms(station.robots).set_guiding("panda", pressed=False)
    station.switch_controllers(SwitchRequest(("arm",), ()))


@pytest.mark.parametrize("kind", [FaultKind.STUCK_JOINT, FaultKind.NAN_SENSOR])
def test_faults_are_listed_and_cleared(station, kind):
    Arms(station.robots).inject("panda", SimulatedFault(kind, 1_000, joint=3))
    station.loop.step(10)
    (fault,) = Arms(station.robots).faults("panda")
    assert (fault.kind, fault.joint, 980 < fault.cycles < 1_000) == (kind, 3, True)
    Arms(station.robots).clear_faults("panda")
    station.loop.step()
    assert Arms(station.robots).faults("panda") == []
    assert all(q == q for q in Arms(station.robots).state("panda").q)


def test_blind_sensor_ends_what_uses_it_and_nothing_else(station):
    group = "effort_controllers/JointGroupPositionController"
    gains = {joint: {"pid": {"p": 100.0, "d": 5.0}} for joint in JOINTS}
    station.load_controller("torques", group, {"joints": JOINTS, **gains})
    station.switch_controllers(SwitchRequest(("torques",), ()))
    station.loop.step(100)
    Arms(station.robots).inject(
        "panda", SimulatedFault(FaultKind.NAN_SENSOR, 20, joint=2)
    )
    station.loop.step(100)

    status = station.controller("torques")

    assert status.state is ControllerState.STOPPED
    assert "blind: the position of joint2 reads nan" in status.fault
    assert station.latest().mode == "idle"
    assert station.ready() is not None  # nobody runs the loop here, and it has not died
    station.switch_controllers(SwitchRequest(("torques",), ()))
    station.loop.step(10)
    assert station.latest().mode == "move"


def test_an_arm_that_recovers_in_a_contact_says_what_will_stop_it_again(station):
    arms = Arms(station.robots)
    (arm,) = station.loop.hw.get(FrankaServicesInterface).handles()
    assert arms.report("panda").caution is None
    arm.simulation().apply_force("panda_hand", [0.0, 25.0, 0.0], [0.0] * 3, 5.0)
    station.loop.step(500)
    with pytest.raises(SwitchRefusedError, match=r"reflex \(cartesian_reflex at y"):
        station.switch_controllers(SwitchRequest(("arm",), ()))
    station.robots.recover("panda")
    station.loop.step(500)

    report = arms.report("panda")

    assert report.robot_mode is RobotMode.IDLE
    assert "y is raised above 20 N, and the estimate is 2" in report.caution
    assert "set_force_torque_collision_behavior" in report.caution
