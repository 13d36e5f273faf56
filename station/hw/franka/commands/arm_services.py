"""The services of an arm behind FrankaHW: setters, recovery, connection, faults."""

from collections.abc import Callable, Sequence

import numpy as np
from typing_extensions import override

from station.core.errors import ArmCommandError, InvalidCommandError
from station.core.franka.franka_errors import ArmError
from station.core.franka.franka_model import FrankaModelHandle
from station.core.franka.franka_robot_state import RobotMode, RobotState
from station.core.franka.franka_services import (
    ArmSimulation,
    CollisionBehavior,
    FrankaServices,
)
from station.hw.franka.arm.collision_behavior import (
    check_collision_behavior,
    near_collisions,
)
from station.hw.franka.arm.control_mode import ControlMode
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.franka.arm.robot_arm import ControllerMode, RobotArm
from station.hw.franka.arm.service_limits import (
    JOINT_STIFFNESS,
    ROTATIONAL_STIFFNESS,
    TRANSLATIONAL_STIFFNESS,
    ServiceLimits,
    check_load,
    check_ranges,
    field_error,
)
from station.hw.franka.arm.transform_check import check_transform
from station.hw.franka.commands.motion_start import MotionStart
from station.reports import ArmRecord

# Asymmetry that rounding may leave in a tensor turned into another frame.
_SYMMETRY = 1e-9


class ArmServices(FrankaServices):
    """The services of an arm, with the checks of their values. Control thread only.

    Source: franka_ros@c11f000 franka_hw/src/services.cpp; differs: values are checked
    here and refused with their range.

    Args:
        arm_id: Name of the arm.
        arm: The arm.
        motion: The motion that the running controllers command.
        model: The model of the arm.
        collision_behavior: The configured thresholds, set again at every connection.
        limits: The largest loads and pushes.
        internal_controller: Returns the configured controller of motions; None when
            none is configured.
    """

    def __init__(
        self,
        arm_id: str,
        arm: RobotArm,
        motion: MotionStart,
        model: FrankaModelHandle,
        *,
        collision_behavior: CollisionBehavior,
        limits: ServiceLimits,
        internal_controller: Callable[[], ControllerMode | None] = lambda: None,
    ) -> None:
        super().__init__(arm_id)
        self._arm = arm
        self._motion = motion
        self._model = model
        self._collision_behavior = collision_behavior
        self._limits = limits
        self._internal_controller = internal_controller
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
    def near_errors(self) -> list[ArmError]:
        behavior = self._arm.collision_behavior()
        return [] if behavior is None else near_collisions(self._arm.state, behavior)

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
        values = check_ranges(joint_stiffness, [JOINT_STIFFNESS] * 7, "joint_stiffness")
        self._check_use(ControllerMode.JOINT_IMPEDANCE)
        self._arm.set_joint_impedance(values)
        # Noted only after the arm has accepted it: a refused one must have no effect.
        self._motion.impedance = ControllerMode.JOINT_IMPEDANCE

    @override
    def set_cartesian_impedance(self, cartesian_stiffness: Sequence[float]) -> None:
        self._check_connected()
        ranges = [TRANSLATIONAL_STIFFNESS] * 3 + [ROTATIONAL_STIFFNESS] * 3
        values = check_ranges(cartesian_stiffness, ranges, "cartesian_stiffness")
        self._check_use(ControllerMode.CARTESIAN_IMPEDANCE)
        self._arm.set_cartesian_impedance(values)
        self._motion.impedance = ControllerMode.CARTESIAN_IMPEDANCE

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
        check_load(mass, F_x_center_load, load_inertia, self._limits)
        tensor = np.reshape(load_inertia, (3, 3))
        if (
            np.abs(tensor - tensor.T).max() > _SYMMETRY
            or np.linalg.eigvalsh(tensor)[0] < -_SYMMETRY
        ):
            raise InvalidCommandError(
                f"No body has the inertia {list(load_inertia)} kg m^2.",
                remedy="Give a symmetric tensor without negative moments.",
                details=field_error(
                    "load_inertia",
                    "must be symmetric without negative moments",
                    list(load_inertia),
                ),
            )
        load = RigidBody(mass, tuple(F_x_center_load), tuple(load_inertia))
        self._arm.set_load(load)

    @override
    def set_collision_behavior(self, behavior: CollisionBehavior) -> None:
        self._check_connected()
        check_collision_behavior(behavior)
        self._arm.set_collision_behavior(behavior)

    @override
    def check_recovery(self) -> None:
        self._check_connected()
        try:
            self._arm.check_recovery()
        except ArmCommandError as exc:
            # The arm's message does not name it; a station may have several arms.
            message = exc.message.replace("The arm ", f"Arm '{self.name}' ", 1)
            raise ArmCommandError(message, remedy=exc.remedy) from exc

    @override
    def error_recovery(self) -> bool:
        self.check_recovery()
        arm = self._arm
        # Read before the recovery, which clears the error.
        had_error = arm.state.robot_mode is RobotMode.REFLEX or arm.is_lost()
        arm.automatic_error_recovery()
        return had_error

    @override
    def connect(self) -> None:
        # The recovery of a real arm restores a broken connection.
        if self._is_connected and self._arm.is_lost():
            self._arm.automatic_error_recovery()
            return
        if self._is_connected:
            raise ArmCommandError(
                f"Arm '{self.name}' is connected already.", remedy="Use it."
            )
        self._is_connected = True
        # As in franka_hw, only the thresholds are sent again.
        self._arm.set_collision_behavior(self._collision_behavior)

    @override
    def disconnect(self) -> None:
        self._check_connected()
        # A controller would continue to command an arm that no longer listens.
        if self._motion.mode is not ControlMode.NONE:
            raise ArmCommandError(
                f"Arm '{self.name}' cannot be disconnected: a controller commands "
                f"{self._motion.mode.describe()}.",
                remedy="Stop the controllers of this arm first.",
            )
        self._is_connected = False

    def _check_use(self, needed: ControllerMode) -> None:
        """Refuse an impedance that no motion would use.

        Args:
            needed: The internal controller that uses the impedance.

        Raises:
            ArmCommandError: Another internal controller is configured.
        """
        configured = self._internal_controller()
        if configured not in (None, needed):
            raise ArmCommandError(
                f"Arm '{self.name}' would not use this impedance: internal_controller "
                f"is '{configured.value}'.",
                remedy=f"Set internal_controller of the robot to '{needed.value}'; "
                "without this parameter the impedance that is set last acts.",
            )

    def _check_connected(self) -> None:
        if not self._is_connected:
            raise ArmCommandError(
                f"Arm '{self.name}' is not connected.", remedy="Connect it first."
            )
