"""Parameters and handles of a Franka arm, and the rate limit of its torques."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from station.core.control.controller import (
    MultiInterfaceController,
    require_interface,
)
from station.core.declared_parameter import (
    DeclaredParameter,
    NameKind,
    declare_string,
    declare_strings,
)
from station.core.franka import (
    FrankaModelHandle,
    FrankaModelInterface,
    FrankaStateHandle,
    FrankaStateInterface,
)
from station.core.hardware.interfaces import EffortJointInterface, JointGroup
from station.core.hardware.robot_hw import RobotHW
from station.core.numerics.command_rates import filter_commands
from station.core.parameters import Parameters
from station.memory.doubles import doubles

LARGEST_STEP = 1.0
"""Largest change of a torque per cycle [Nm]."""
JOINT_COUNT = 7
"""Number of joints of an arm."""
ARM_ID = declare_string("arm_id", "the arm, e.g. `panda`", names=NameKind.ARM)
JOINT_NAMES = declare_strings(
    "joint_names",
    "the seven joints of the arm, from base to flange",
    size=JOINT_COUNT,
    names=NameKind.JOINT,
)


class ArmTorqueController(MultiInterfaceController):
    """A controller that commands torques to the joints of one arm by its model.

    Parameters: `arm_id`; `joint_names`, 7 names.
    """

    required_interfaces: ClassVar[tuple[type, ...]] = (
        EffortJointInterface,
        FrankaModelInterface,
        FrankaStateInterface,
    )
    own_parameters: ClassVar[tuple[DeclaredParameter, ...]] = (ARM_ID, JOINT_NAMES)


def read_arm_id(params: Parameters) -> str:
    """Return the parameter `arm_id`.

    Raises:
        ParameterError: `arm_id` is missing or not a string.
    """
    return ARM_ID.read_str(params)


def read_arm_joints(params: Parameters) -> list[str]:
    """Return the parameter `joint_names`, the joints from base to flange.

    Raises:
        ParameterError: `joint_names` is missing, or does not name 7 joints.
    """
    names = JOINT_NAMES.read_str_list(params)
    if len(set(names)) != JOINT_COUNT:
        JOINT_NAMES.refuse(params, names, f"a list of {JOINT_COUNT} different joints")
    return names


def claim_torques(hw: RobotHW, joint_names: Sequence[str]) -> JointGroup:
    """Claim the joints of an arm for torque commands and return them.

    Raises:
        ControllerLoadError: The robot has no effort interface.
        ResourceNotFoundError: The robot has no joint of that name.
    """
    efforts = require_interface(hw, EffortJointInterface)
    return JointGroup([efforts.get_handle(name) for name in joint_names])


def find_state(hw: RobotHW, arm_id: str) -> FrankaStateHandle:
    """Return the handle of an arm's state.

    Raises:
        ControllerLoadError: The robot has no states of Franka arms.
        ResourceNotFoundError: The robot has no arm of that name.
    """
    return require_interface(hw, FrankaStateInterface).get_handle(f"{arm_id}_robot")


def find_model(hw: RobotHW, arm_id: str) -> FrankaModelHandle:
    """Return the handle of an arm's model.

    Raises:
        ControllerLoadError: The robot has no models of Franka arms.
        ResourceNotFoundError: The robot has no arm of that name.
    """
    return require_interface(hw, FrankaModelInterface).get_handle(f"{arm_id}_model")


def saturate_torque_rate(
    tau: NDArray[np.float64], last_tau: Sequence[float]
) -> list[float]:
    """Return torques that differ from the last torques by at most `LARGEST_STEP`.

    Args:
        tau: Desired torques [Nm], shape (7,).
        last_tau: Torques commanded last, `tau_J_d` [Nm], shape (7,).
    """
    result = doubles(tau)
    last = doubles(last_tau)
    filter_commands(result, last, 1.0, LARGEST_STEP, result, len(result))
    return [*result]
