"""Services of an arm that is not simulated are refused where they must be."""

from dataclasses import replace

import pytest

import station
from station.core.errors import ArmCommandError, InvalidCommandError
from station.core.franka import FrankaServicesInterface
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.arm.collision_behavior import DEFAULT_COLLISION_BEHAVIOR
from station.hw.franka.commands.arm_services import ArmServices
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


@pytest.mark.parametrize(("stiffness", "moved"), [(200.0, 0.05), (2000.0, 0.005)])
def test_cartesian_impedance_acts_in_the_motions_of_the_default_robot(stiffness, moved):
    with station.open(settings={"robot.realism": "ideal"}) as robot:
        robots = robot.facade.robots
        arm = robots.get("panda", ArmServices)
        values = [stiffness] * 3 + [50.0] * 3
        robots.run(lambda: arm.set_cartesian_impedance(values))
        robot.switch(start=["cartesian_streaming_controller"])
        robot.run(0.5)
        before = arm.get_robot_state().O_T_EE[13]
        push = [0.0, 10.0, 0.0], [0.0] * 3, 2.5
        robots.run(lambda: arm.simulation().apply_force("panda_hand", *push))
        robot.run(2.3)
        assert arm.get_robot_state().O_T_EE[13] - before == pytest.approx(
            moved, rel=0.1
        )


@pytest.mark.parametrize(
    ("configured", "service", "values"),
    [
        ("joint_impedance", "set_cartesian_impedance", [200.0] * 6),
        ("cartesian_impedance", "set_joint_impedance", [3000.0] * 7),
    ],
)
def test_impedance_that_no_motion_would_have_is_refused(configured, service, values):
    settings = {"robot.internal_controller": configured}
    with station.open(settings=settings) as robot:
        arm = robot.facade.robots.get("panda", ArmServices)
        with pytest.raises(
            ArmCommandError, match=f"internal_controller is '{configured}"
        ):
            robot.facade.robots.run(lambda: getattr(arm, service)(values))
