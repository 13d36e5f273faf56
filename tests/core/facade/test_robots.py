"""Arms through the facade: reflex, recovery, settings, seen from outside."""

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
from station.core.loop.control_loop import ControlLoop
from station.core.parameters import Parameters
from tests.franka_station import JOINTS, make_franka_station

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

    assert station.robots.names() == []
    with pytest.raises(ArmNotFoundError, match="no arm 'panda'"):
        station.robots.state("panda")


def test_state_and_model_are_of_this_cycle(station):
    station.loop.step(10)

    state = station.robots.state("panda")
    model = station.robots.model("panda", Frame.END_EFFECTOR)

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

    state = station.robots.state("panda")
    model = station.robots.model("panda", Frame.FLANGE)

    assert state.O_ddP_O == pytest.approx([1.0, -2.0, -1.62])
    assert abs(model.gravity[0]) > 0.5
    assert model.gravity == pytest.approx(state.tau_J, abs=0.02)


def test_reflex_stops_controllers_in_the_same_cycle(moving):
    epoch = moving.epoch
    moving.robots.inject("panda", HIT)
    for _ in range(100):
        moving.loop.step()
        running = moving.controller("arm").state is ControllerState.RUNNING
        assert running is (moving.latest().mode == "move")
    status = moving.controller("arm")
    report = moving.robots.report("panda")

    assert status.state is ControllerState.STOPPED
    assert "arm 'panda' went to reflex (cartesian_reflex" in status.fault
    assert report.mode is RobotMode.REFLEX
    assert "cartesian_reflex" in {error.name for error in report.errors}
    assert "recover" in report.remedy
    assert moving.epoch == epoch


def test_nothing_can_be_started_before_recovery(moving):
    moving.robots.inject("panda", HIT)
    moving.loop.step(100)

    with pytest.raises(SwitchRefusedError, match="mode reflex; remove the cause"):
        moving.switch_controllers(SwitchRequest(("arm",), ()))


def test_recovery_leaves_controllers_stopped_and_voids_commands(moving):
    moving.robots.inject("panda", HIT)
    moving.loop.step(100)
    epoch = moving.epoch

    assert moving.robots.recover("panda") == ()

    moving.loop.step(10)
    assert moving.epoch == epoch + 1
    assert moving.latest().mode == "idle"
    assert moving.controller("arm").state is ControllerState.STOPPED
    moving.switch_controllers(SwitchRequest(("arm",), ()))
    moving.loop.step(10)
    assert moving.latest().mode == "move"


def test_recovery_can_start_what_ran_before(moving):
    moving.robots.inject("panda", HIT)
    moving.loop.step(200)

    assert moving.robots.recover("panda", restart=True) == ("arm",)

    moving.loop.step(200)
    assert moving.controller("arm").state is ControllerState.RUNNING
    assert moving.latest().mode == "move"


def test_user_stop_stops_controllers_until_it_is_released(moving):
    moving.robots.set_user_stop("panda", pressed=True)
    moving.loop.step()

    assert moving.latest().mode == "user_stopped"
    assert moving.controller("arm").state is ControllerState.STOPPED
    with pytest.raises(ArmCommandError, match="user stop"):
        moving.robots.recover("panda")
    moving.robots.set_user_stop("panda", pressed=False)
    assert moving.robots.report("panda").mode is RobotMode.IDLE


def test_settings_are_refused_while_the_arm_moves(moving):
    with pytest.raises(ArmCommandError, match="while a motion runs"):
        moving.robots.set_joint_impedance("panda", [100.0] * 7)
    with pytest.raises(ArmCommandError, match="a controller commands"):
        moving.robots.disconnect("panda")


def test_settings_are_checked_against_their_ranges(station):
    robots = station.robots
    robots.set_joint_impedance("panda", [14250.0] * 7)
    with pytest.raises(InvalidCommandError, match="joint_stiffness"):
        robots.set_joint_impedance("panda", [14251.0] * 7)
    robots.set_cartesian_impedance("panda", [10.0] * 3 + [300.0] * 3)
    with pytest.raises(InvalidCommandError, match="cartesian_stiffness"):
        robots.set_cartesian_impedance("panda", [10.0] * 3 + [301.0] * 3)
    with pytest.raises(InvalidCommandError, match="no transform"):
        robots.set_EE_frame("panda", [0.0] * 16)
    with pytest.raises(
        InvalidCommandError,
        match=r"load of -1\.0 kg is not possible; allowed are 0 to 3 kg",
    ):
        robots.set_load("panda", -1.0, [0.0] * 3, [0.0] * 9)


def test_frames_and_load_show_in_the_state(station):
    shift = [1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0.1, 1.0]
    before = station.robots.state("panda")
    station.robots.set_EE_frame("panda", shift)
    station.robots.set_K_frame("panda", shift)
    station.robots.set_load("panda", 0.5, [0.01, -0.2, 0.03], [0.0] * 9)

    state = station.robots.state("panda")

    assert state.O_T_EE[14] == pytest.approx(before.O_T_EE[14] - 0.1)
    assert shift == state.EE_T_K
    assert state.m_total == pytest.approx(1.26)


def test_disconnected_arm_takes_no_controllers(station):
    station.robots.disconnect("panda")
    with pytest.raises(SwitchRefusedError, match="not connected"):
        station.switch_controllers(SwitchRequest(("arm",), ()))
    with pytest.raises(ArmCommandError, match="not connected"):
        station.robots.disconnect("panda")
    station.robots.connect("panda")
    station.switch_controllers(SwitchRequest(("arm",), ()))
    with pytest.raises(ArmCommandError, match="connected already"):
        station.robots.connect("panda")


def test_push_shows_in_the_wrench(station):
    station.robots.apply_force(
        "panda", "panda_hand", [0.0, 5.0, 0.0], [0.0, 0.0, 0.0], 1.0
    )
    station.loop.step(400)

    state = station.robots.state("panda")

    assert state.O_F_ext_hat_K[1] == pytest.approx(-5.0, rel=0.02)
    assert station.robots.log("panda") == []


def test_late_cycle_is_longer_and_counted_and_no_error(moving):
    moving.loop.reset_statistics()
    moving.robots.inject("panda", SimulatedFault(FaultKind.DELAYED_CYCLE, 10))
    before = moving.robots.state("panda").time
    moving.loop.step(5)

    state = moving.robots.state("panda")

    assert moving.loop.report().skipped == 10
    periods = [one.period for one in moving.snapshots.read_since(0)[0]][-5:]
    assert periods == pytest.approx([0.011, 0.001, 0.001, 0.001, 0.001])

    assert state.time == pytest.approx(before + 0.015)
    assert state.robot_mode is RobotMode.MOVE
    assert state.control_command_success_rate == pytest.approx(0.9)


def test_delay_of_twenty_cycles_stops_the_arm(moving):
    moving.robots.inject("panda", SimulatedFault(FaultKind.DELAYED_CYCLE, 20))
    moving.loop.step(2)

    (error,) = moving.robots.report("panda").errors

    assert error.name == "communication_constraints_violation"
    assert "communication_constraints_violation" in moving.controller("arm").fault


@pytest.mark.parametrize(
    "use",
    [
        lambda robots: robots.set_user_stop("panda", pressed=True),
        lambda robots: robots.set_guiding("panda", pressed=True),
        lambda robots: robots.apply_force("panda", "hand", [0.0] * 3, [0.0] * 3, 1.0),
        lambda robots: robots.inject("panda", HIT),
        lambda robots: robots.faults("panda"),
        lambda robots: robots.clear_faults("panda"),
    ],
)
def test_arm_that_is_not_simulated_refuses_what_only_simulations_can_do(
    station, monkeypatch, use
):
    arm = station.loop.hw.get(FrankaServicesInterface).get_handle("panda")
    monkeypatch.setattr(arm, "simulation", lambda: None)
    epoch = station.epoch

    with pytest.raises(ArmCommandError, match="Arm 'panda' is not simulated"):
        use(station.robots)
    assert station.epoch == epoch


def test_delay_of_seconds_is_refused(moving):
    with pytest.raises(InvalidCommandError, match="delayed cycle is 501"):
        moving.robots.inject("panda", SimulatedFault(FaultKind.DELAYED_CYCLE, 501))


def test_recovery_without_an_error_disturbs_nobody(moving):
    epoch = moving.epoch

    assert moving.robots.recover("panda", restart=True) == ()
    assert moving.robots.recover_all() == ()

    moving.loop.step()
    assert moving.epoch == epoch
    assert moving.controller("arm").state is ControllerState.RUNNING


def test_restart_begins_with_a_period_of_zero(moving, monkeypatch):
    controller = moving.loop.manager.get_controller("arm")
    periods = []
    update = controller.update

    def watched(time, period):
        periods.append(period)
        update(time, period)

    monkeypatch.setattr(controller, "update", watched)
    moving.robots.inject("panda", HIT)
    moving.loop.step(200)
    periods.clear()
    moving.robots.recover("panda", restart=True)
    moving.loop.step(2)

    assert periods == [0.0, 0.001, 0.001]


def test_what_an_earlier_error_stopped_is_not_started_by_a_later_recovery(moving):
    moving.robots.inject("panda", HIT)
    moving.loop.step(200)
    moving.robots.recover("panda")
    moving.robots.inject("panda", HIT)  # while nothing runs
    moving.loop.step(200)
    assert moving.latest().mode == "reflex"

    assert moving.robots.recover("panda", restart=True) == ()


def test_recovery_of_a_moving_arm_returns_when_it_is_at_rest(station):
    group = "velocity_controllers/JointGroupVelocityController"
    station.load_controller("speed", group, {"joints": JOINTS})
    station.switch_controllers(SwitchRequest(("speed",), ()))
    station.set_command("speed", [0.3] * 7)
    station.loop.step(300)
    station.robots.set_user_stop("panda", pressed=True)
    station.loop.step()
    station.robots.set_user_stop("panda", pressed=False)

    assert station.robots.report("panda").mode is RobotMode.IDLE
    station.switch_controllers(SwitchRequest(("arm",), ()))


def test_guided_arm_takes_no_controllers(station):
    station.robots.set_guiding("panda", pressed=True)
    with pytest.raises(SwitchRefusedError, match="mode guiding"):
        station.switch_controllers(SwitchRequest(("arm",), ()))
    station.robots.set_guiding("panda", pressed=False)
    station.switch_controllers(SwitchRequest(("arm",), ()))


@pytest.mark.parametrize("kind", [FaultKind.STUCK_JOINT, FaultKind.NAN_SENSOR])
def test_faults_are_listed_and_cleared(station, kind):
    station.robots.inject("panda", SimulatedFault(kind, 1_000, joint=3))
    station.loop.step(10)
    (fault,) = station.robots.faults("panda")
    assert (fault.kind, fault.joint, 980 < fault.cycles < 1_000) == (kind, 3, True)
    station.robots.clear_faults("panda")
    station.loop.step()
    assert station.robots.faults("panda") == []
    assert all(q == q for q in station.robots.state("panda").q)


def test_blind_sensor_ends_what_uses_it_and_nothing_else(station):
    group = "effort_controllers/JointGroupPositionController"
    gains = {joint: {"pid": {"p": 100.0, "d": 5.0}} for joint in JOINTS}
    station.load_controller("torques", group, {"joints": JOINTS, **gains})
    station.switch_controllers(SwitchRequest(("torques",), ()))
    station.loop.step(100)
    station.robots.inject("panda", SimulatedFault(FaultKind.NAN_SENSOR, 20, joint=2))
    station.loop.step(100)

    status = station.controller("torques")

    assert status.state is ControllerState.STOPPED
    assert "blind: the position of joint2 reads nan" in status.fault
    assert station.latest().mode == "idle"
    assert station.ready() != ""  # nobody runs the loop here, and it has not died
    station.switch_controllers(SwitchRequest(("torques",), ()))
    station.loop.step(10)
    assert station.latest().mode == "move"
