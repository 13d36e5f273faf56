"""The services of one arm behind FrankaHW: setters, recovery, connection, faults."""

from collections.abc import Sequence
from math import isfinite

import numpy as np
from typing_extensions import override

from station.core.errors import ArmCommandError, InvalidCommandError
from station.core.franka.arm_simulation import ArmSimulation
from station.core.franka.franka_errors import ArmError
from station.core.franka.franka_model import FrankaModelHandle
from station.core.franka.franka_robot_state import RobotMode, RobotState
from station.core.franka.franka_services import (
    ArmRecord,
    CollisionBehavior,
    FrankaServices,
)
from station.hw.franka.arm.collision_behavior import collision_behavior_problem
from station.hw.franka.arm.control_mode import ControlMode
from station.hw.franka.arm.load import Load
from station.hw.franka.arm.robot_arm import RobotArm
from station.hw.franka.arm.transform_check import check_transform
from station.hw.franka.commands.motion_start import MotionStart

JOINT_STIFFNESS = (0.0, 14250.0)
"""Range of the joint impedance [Nm/rad]."""
TRANSLATIONAL_STIFFNESS = (10.0, 3000.0)
"""Range of the Cartesian impedance along the axes [N/m]."""
ROTATIONAL_STIFFNESS = (1.0, 300.0)
"""Range of the Cartesian impedance about the axes [Nm/rad]."""
_SYMMETRY = 1e-9


class ArmServices(FrankaServices):
    """The services of an arm, with the checks of their values. Control thread only.

    Source: franka_ros@c11f000 franka_hw/src/services.cpp; differs: values are checked
    here and refused with their range.

    Args:
        arm_id: Name of the arm.
        arm: The arm.
        motion: What the running controllers command.
        model: The model of the arm.
        collision_behavior: The configured thresholds, set again at every connection.
    """

    def __init__(
        self,
        arm_id: str,
        arm: RobotArm,
        motion: MotionStart,
        model: FrankaModelHandle,
        collision_behavior: CollisionBehavior,
    ) -> None:
        super().__init__(arm_id)
        self._arm = arm
        self._motion = motion
        self._model = model
        self._collision_behavior = collision_behavior
        self._is_connected = True

    @override
    def robot_mode(self) -> RobotMode:
        return self._arm.state.robot_mode

    @override
    def get_robot_state(self) -> RobotState:
        self._arm.refresh_state()
        return self._arm.state.copy()

    @override
    def model(self) -> FrankaModelHandle:
        return self._model

    @override
    def errors(self) -> list[ArmError]:
        return self._arm.errors()

    @override
    def log(self) -> list[ArmRecord]:
        return self._arm.log()

    @override
    def remedy(self) -> str | None:
        return self._arm.remedy() if self._is_connected else "connect the arm"

    @override
    def simulation(self) -> ArmSimulation | None:
        return self._arm.simulation()

    @override
    def is_connected(self) -> bool:
        return self._is_connected

    @override
    def set_joint_impedance(self, joint_stiffness: Sequence[float]) -> None:
        self._check_connected()
        values = _in_range(joint_stiffness, [JOINT_STIFFNESS] * 7, "joint_stiffness")
        self._arm.set_joint_impedance(values)

    @override
    def set_cartesian_impedance(self, cartesian_stiffness: Sequence[float]) -> None:
        self._check_connected()
        ranges = [TRANSLATIONAL_STIFFNESS] * 3 + [ROTATIONAL_STIFFNESS] * 3
        values = _in_range(cartesian_stiffness, ranges, "cartesian_stiffness")
        self._arm.set_cartesian_impedance(values)

    @override
    def set_EE_frame(self, NE_T_EE: Sequence[float]) -> None:
        self._check_connected()
        self._arm.set_end_effector_frame(check_transform(NE_T_EE, "NE_T_EE"))

    @override
    def set_K_frame(self, EE_T_K: Sequence[float]) -> None:
        self._check_connected()
        self._arm.set_stiffness_frame(check_transform(EE_T_K, "EE_T_K"))

    @override
    def set_load(
        self,
        mass: float,
        F_x_center_load: Sequence[float],
        load_inertia: Sequence[float],
    ) -> None:
        self._check_connected()
        numbers = (mass, *F_x_center_load, *load_inertia)
        if len(numbers) != 13 or not isfinite(sum(numbers)) or mass < 0.0:
            raise InvalidCommandError(
                f"a load of {mass} kg at {list(F_x_center_load)} with inertia "
                f"{list(load_inertia)} is not possible",
                remedy="give a mass of 0 or more, 3 and 9 finite numbers",
                details=_field_error("mass", "must be 0 or more, all finite", mass),
            )
        tensor = np.reshape(load_inertia, (3, 3))
        if (
            np.abs(tensor - tensor.T).max() > _SYMMETRY
            or np.linalg.eigvalsh(tensor)[0] < -_SYMMETRY
        ):
            raise InvalidCommandError(
                f"no body has the inertia {list(load_inertia)}",
                remedy="give a symmetric tensor without negative moments",
                details=_field_error(
                    "load_inertia",
                    "must be symmetric without negative moments",
                    list(load_inertia),
                ),
            )
        load = Load(mass, tuple(F_x_center_load), tuple(load_inertia))
        self._arm.set_load(load)

    @override
    def set_collision_behavior(self, behavior: CollisionBehavior) -> None:
        self._check_connected()
        problem = collision_behavior_problem(behavior)
        if problem is not None:
            field, allowed = problem.field, problem.allowed
            value = getattr(behavior, field)
            raise InvalidCommandError(
                f"the collision threshold '{field}' {list(value)} is not possible",
                remedy=f"give {allowed}",
                details=_field_error(field, f"must be {allowed}", list(value)),
            )
        self._arm.set_collision_behavior(behavior)

    @override
    def check_recovery(self) -> None:
        self._check_connected()
        try:
            self._arm.check_recovery()
        except ArmCommandError as exc:
            # An arm does not know its name; a station may have several arms.
            message = exc.message.replace("The arm ", f"Arm '{self.name}' ", 1)
            raise ArmCommandError(message, remedy=exc.remedy) from exc

    @override
    def error_recovery(self) -> bool:
        self.check_recovery()
        arm = self._arm
        had_error = arm.state.robot_mode is RobotMode.REFLEX
        arm.automatic_error_recovery()
        return had_error

    @override
    def connect(self) -> None:
        if self._is_connected:
            raise ArmCommandError(
                f"arm '{self.name}' is connected already", remedy="use it"
            )
        self._is_connected = True
        # Of the settings the thresholds alone are sent again, as franka_hw does.
        self._arm.set_collision_behavior(self._collision_behavior)

    @override
    def disconnect(self) -> None:
        self._check_connected()
        if self._motion.mode is not ControlMode.NONE:
            raise ArmCommandError(
                f"arm '{self.name}' cannot be disconnected: a controller commands "
                f"{self._motion.mode.describe()}",
                remedy="stop the controllers of this arm first",
            )
        self._is_connected = False

    def _check_connected(self) -> None:
        if not self._is_connected:
            raise ArmCommandError(
                f"arm '{self.name}' is not connected", remedy="connect it first"
            )


def _in_range(
    values: Sequence[float], ranges: Sequence[tuple[float, float]], what: str
) -> list[float]:
    found = [
        _field_error(f"{what}/{i}", f"must be {low:g} to {high:g}", value)["errors"][0]
        for i, (value, (low, high)) in enumerate(zip(values, ranges, strict=False))
        if not low <= value <= high
    ]
    if len(values) != len(ranges) or found:
        allowed = ", ".join(f"{low:g} to {high:g}" for low, high in ranges)
        raise InvalidCommandError(
            f"'{what}' is {list(values)}; allowed are {len(ranges)} numbers",
            remedy=f"give numbers in these ranges: {allowed}",
            details={"errors": found},
        )
    return list(values)


def _field_error(
    field: str, message: str, value: object
) -> dict[str, list[dict[str, str]]]:
    """Return what the API says about one field of a request."""
    error = {"field": f"body/{field}", "message": message, "value": str(value)}
    return {"errors": [error]}
