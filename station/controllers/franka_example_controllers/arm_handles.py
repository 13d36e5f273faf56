"""How an example finds the handles of its arm, and changes its torques slowly."""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from station.core.errors import ControllerLoadError
from station.core.franka import (
    FrankaModelHandle,
    FrankaModelInterface,
    FrankaStateHandle,
    FrankaStateInterface,
)
from station.core.hardware.interfaces import EffortJointInterface, JointGroup
from station.core.hardware.interfaces.interface_manager import interface_type_name
from station.core.hardware.robot_hw import RobotHW

LARGEST_STEP = 1.0
"""Of a torque per cycle [Nm]."""

InterfaceT = TypeVar("InterfaceT")


def require(hw: RobotHW, interface_type: type[InterfaceT]) -> InterfaceT:
    """Return the robot's interface of a type.

    Raises:
        ControllerLoadError: The robot has none.
    """
    interface = hw.get(interface_type)
    if interface is None:
        name = interface_type_name(interface_type)
        raise ControllerLoadError(
            f"The robot has no interface '{name}'.",
            remedy=f"It offers: {', '.join(hw.get_names()) or 'none'}.",
            details={"hardware_interface": name},
        )
    return interface


def claim_torques(hw: RobotHW, joint_names: Sequence[str]) -> JointGroup:
    """Return the joints of an arm to be commanded by torques.

    Raises:
        ControllerLoadError: The robot takes no torques.
        ResourceNotFoundError: It has no such joint.
    """
    efforts = require(hw, EffortJointInterface)
    return JointGroup([efforts.get_handle(name) for name in joint_names])


def find_state(hw: RobotHW, arm_id: str) -> FrankaStateHandle:
    """Return the state of an arm.

    Raises:
        ControllerLoadError: The robot has no such states.
        ResourceNotFoundError: It has no such arm.
    """
    return require(hw, FrankaStateInterface).get_handle(f"{arm_id}_robot")


def find_model(hw: RobotHW, arm_id: str) -> FrankaModelHandle:
    """Return the model of an arm.

    Raises:
        ControllerLoadError: The robot has no models.
        ResourceNotFoundError: It has no such arm.
    """
    return require(hw, FrankaModelInterface).get_handle(f"{arm_id}_model")


def saturate_torque_rate(
    tau: NDArray[np.float64], last_tau: Sequence[float]
) -> list[float]:
    """Return torques that are at most `LARGEST_STEP` away from the last ones.

    Args:
        tau: Wanted torques [Nm], shape (7,).
        last_tau: What was commanded last, `tau_J_d` [Nm], shape (7,).
    """
    last = np.asarray(last_tau)
    step = np.clip(tau - last, -LARGEST_STEP, LARGEST_STEP)
    result: list[float] = (last + step).tolist()
    return result
