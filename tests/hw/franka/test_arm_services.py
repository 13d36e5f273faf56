"""Services of an arm that is not simulated are refused where they must be."""

import pytest

from station.core.errors import ArmCommandError, InvalidCommandError
from station.core.interfaces import FrankaServicesInterface
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.franka_hw import FrankaHW


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
