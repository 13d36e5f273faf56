"""Services of an arm that is not simulated are refused where they must be."""

from dataclasses import replace

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.errors import ArmCommandError, InvalidCommandError
from station.core.franka import FaultKind, FrankaServicesInterface, SimulatedFault
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.arm.robot_arm import RobotArm
from station.hw.franka.franka_hw import FrankaHW
from station.hw.franka.simulated.simulation import ArmPlacement, simulate


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
    with pytest.raises(InvalidCommandError, match="no body has the inertia"):
        services.set_load(1.0, [0.0] * 3, inertia)


def test_recovery_without_an_error_says_so(services):
    assert services.error_recovery() is False


def test_connecting_sets_the_configured_thresholds_again(services):
    arm = services._simulated()
    configured = arm.contact.behavior
    high = replace(configured, upper_force_thresholds_nominal=(90.0,) * 6)
    services.set_collision_behavior(high)
    assert arm.contact.behavior == high
    services.disconnect()
    services.connect()
    assert arm.contact.behavior == configured


@pytest.fixture
def real():
    """Return the services of an arm that is none of the simulated ones."""
    description = load_robot_files("example-robot-data:panda")
    simulated = simulate([ArmPlacement("panda", description)]).arms["panda"]

    def passed_on(name):
        return lambda _, *args, **kwargs: getattr(simulated, name)(*args, **kwargs)

    methods = {name: passed_on(name) for name in RobotArm.__abstractmethods__}
    arm = type("RealArm", (RobotArm,), methods)()
    arm.cycle_time, arm.state = simulated.cycle_time, simulated.state
    tree = ParameterTree({
        "robot": {"arm_id": "panda", "robot_description": "example-robot-data:panda"}
    })
    hw = FrankaHW(arm)
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    return hw.get(FrankaServicesInterface).get_handle("panda")


@pytest.mark.parametrize(
    "use",
    [
        lambda arm: arm.set_user_stop(pressed=True),
        lambda arm: arm.set_guiding(pressed=True),
        lambda arm: arm.apply_force("panda_hand", [0.0] * 3, [0.0] * 3, 1.0),
        lambda arm: arm.inject(SimulatedFault(FaultKind.COLLISION, 1)),
        lambda arm: arm.faults(),
        lambda arm: arm.clear_faults(),
    ],
)
def test_what_only_simulations_can_do_is_refused_with_the_reason(real, use):
    with pytest.raises(ArmCommandError, match="arm 'panda' is not simulated"):
        use(real)


def test_settings_and_recovery_are_those_of_any_arm(real):
    real.set_joint_impedance([1000.0] * 7)
    real.set_K_frame([1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0.1, 1.0])
    assert real.get_robot_state().EE_T_K[14] == 0.1
    assert real.error_recovery() is False
