"""Services of an arm that is not simulated are refused where they must be."""

from dataclasses import replace

import pytest

from station.core.errors import ArmCommandError, InvalidCommandError
from station.core.franka import FrankaServicesInterface
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.arm.collision_behavior import DEFAULT_COLLISION_BEHAVIOR
from station.hw.franka.franka_hw import FrankaHW
from tests.hw.franka.scripted_arm import ScriptedArm


@pytest.fixture
def services():
    tree = ParameterTree({
        "robot": {"arm_id": "panda", "robot_description": "example-robot-data:panda"}
    })
    hw = FrankaHW()
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    return hw.get(FrankaServicesInterface).get_handle("panda")


def test_disconnected_arm_takes_no_settings(services):
    services.disconnect()
    assert services.remedy() == "connect the arm"
    with pytest.raises(ArmCommandError, match="not connected"):
        services.set_joint_impedance([100.0] * 7)


@pytest.mark.parametrize(
    "inertia", [[1.0, 0.1, 0, 0, 1, 0, 0, 0, 1], [-1.0, 0, 0, 0, 1, 0, 0, 0, 1]]
)
def test_impossible_inertia_is_refused(services, inertia):
    with pytest.raises(InvalidCommandError, match="No body has the inertia"):
        services.set_load(1.0, [0.0] * 3, inertia)


def test_recovery_without_an_error_reports_that_nothing_was_done(services):
    assert services.error_recovery() is False


@pytest.fixture
def scripted() -> ScriptedArm:
    return ScriptedArm()


@pytest.fixture
def real(scripted):
    """Return the services of an arm that is not simulated."""
    tree = ParameterTree({
        "robot": {"arm_id": "panda", "robot_description": "example-robot-data:panda"}
    })
    hw = FrankaHW(scripted)
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    return hw.get(FrankaServicesInterface).get_handle("panda")


def test_arm_that_is_not_simulated_has_no_controls_of_a_simulation(real):
    assert real.simulation() is None


def test_services_work_with_an_arm_that_is_not_simulated(real):
    real.set_joint_impedance([1000.0] * 7)
    real.set_K_frame([1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0.1, 1.0])
    assert real.get_robot_state().EE_T_K[14] == 0.1
    assert real.error_recovery() is False


def test_connecting_sets_the_configured_thresholds_again(real, scripted):
    high = replace(
        DEFAULT_COLLISION_BEHAVIOR, upper_force_thresholds_nominal=(90.0,) * 6
    )
    real.set_collision_behavior(high)
    assert scripted.behavior == high
    real.disconnect()
    real.connect()
    assert scripted.behavior == DEFAULT_COLLISION_BEHAVIOR
