"""Robots through the facade: declared services, recovery, and what is void."""

import pytest

from station.core.control.controller import ControllerState
from station.core.control.switching import SwitchRequest
from station.core.errors import (
    ArmCommandError,
    ServiceNotFoundError,
    StoppedError,
    SwitchRefusedError,
)
from station.core.facade.station import Station
from station.core.franka import (
    FaultKind,
    RobotMode,
    SimulatedFault,
)
from station.core.franka.arms import Arms
from tests.franka_station import JOINTS, make_franka_station
from tests.service_calls import call_service
from tests.swing_station import make_swing_station

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


def test_reflex_stops_controllers_in_the_same_cycle(moving):
    epoch = moving.epoch
    Arms(moving.robots).inject("panda", HIT)
    for _ in range(100):
        moving.loop.step()
        running = moving.controller("arm").state is ControllerState.RUNNING
        assert running is (moving.latest().mode == "move")
    status = moving.controller("arm")
    report = Arms(moving.robots).report("panda")

    assert status.state is ControllerState.STOPPED
    assert "arm 'panda' went to reflex (cartesian_reflex" in status.fault
    assert report.robot_mode is RobotMode.REFLEX
    assert "cartesian_reflex" in {error.name for error in report.errors}
    assert "recover" in report.remedy
    assert moving.epoch == epoch


def test_nothing_can_be_started_before_recovery(moving):
    Arms(moving.robots).inject("panda", HIT)
    moving.loop.step(100)

    with pytest.raises(SwitchRefusedError, match=r"reflex \(.*\); remove the"):
        moving.switch_controllers(SwitchRequest(("arm",), ()))


def test_recovery_leaves_controllers_stopped_and_voids_commands(moving):
    Arms(moving.robots).inject("panda", HIT)
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
    Arms(moving.robots).inject("panda", HIT)
    moving.loop.step(200)

    assert moving.robots.recover("panda", restart=True) == ("arm",)

    moving.loop.step(200)
    assert moving.controller("arm").state is ControllerState.RUNNING
    assert moving.latest().mode == "move"


def test_user_stop_stops_controllers_until_it_is_released(moving):
    Arms(moving.robots).set_user_stop("panda", pressed=True)
    moving.loop.step()

    assert moving.latest().mode == "user_stopped"
    assert moving.controller("arm").state is ControllerState.STOPPED
    with pytest.raises(ArmCommandError, match="user stop"):
        moving.robots.recover("panda")
    Arms(moving.robots).set_user_stop("panda", pressed=False)
    assert Arms(moving.robots).report("panda").robot_mode is RobotMode.IDLE


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
    Arms(moving.robots).inject("panda", HIT)
    moving.loop.step(200)
    periods.clear()
    moving.robots.recover("panda", restart=True)
    moving.loop.step(2)

    assert periods == [0.0, 0.001, 0.001]


def test_what_an_earlier_error_stopped_is_not_started_by_a_later_recovery(moving):
    Arms(moving.robots).inject("panda", HIT)
    moving.loop.step(200)
    moving.robots.recover("panda")
    Arms(moving.robots).inject("panda", HIT)  # while nothing runs
    moving.loop.step(200)
    assert moving.latest().mode == "reflex"

    assert moving.robots.recover("panda", restart=True) == ()


def test_recovery_of_a_moving_arm_returns_when_it_is_at_rest(station):
    group = "velocity_controllers/JointGroupVelocityController"
    station.load_controller("speed", group, {"joints": JOINTS})
    station.switch_controllers(SwitchRequest(("speed",), ()))
    station.motion.set_command("speed", [0.3] * 7)
    station.loop.step(300)
    Arms(station.robots).set_user_stop("panda", pressed=True)
    station.loop.step()
    Arms(station.robots).set_user_stop("panda", pressed=False)

    assert Arms(station.robots).report("panda").robot_mode is RobotMode.IDLE
    station.switch_controllers(SwitchRequest(("arm",), ()))


@pytest.fixture
def swing() -> Station:
    return make_swing_station()


def test_a_declared_service_is_called_by_name(swing):
    assert call_service(swing, "swing", "push", impulse=2.0) == {
        "impulse": 2.0,
        "pushes": 1.0,
    }
    call_service(swing, "swing", "set_lengths", lengths=[1.0, 3.0])
    assert call_service(swing, "swing", "length") == 3.0


@pytest.mark.parametrize("name", ["oil", "name", "jump"])
def test_what_is_not_declared_cannot_be_called(swing, name):
    with pytest.raises(ServiceNotFoundError, match=f"no service '{name}'") as caught:
        call_service(swing, "swing", name)
    assert "set_lengths, push, length" in caught.value.remedy


def test_a_service_that_moves_is_refused_while_the_station_is_stopped(swing):
    swing.stop("test")
    swing.loop.step()

    with pytest.raises(StoppedError):
        call_service(swing, "swing", "push", impulse=2.0)
    assert call_service(swing, "swing", "length") == 1.0
    assert swing.loop.hw.swing.pushes == []


def test_a_robot_that_cannot_recover_has_nothing_to_recover_from(swing):
    assert swing.robots.names() == ["swing"]
    assert swing.robots.recover("swing") == ()
    assert swing.robots.recover_all() == ()


def test_services_of_an_arm_and_of_its_gripper_share_a_name(station):
    assert station.robots.names() == ["panda"]
    assert {"set_load", "connect"} <= set(station.robots.services("panda"))
