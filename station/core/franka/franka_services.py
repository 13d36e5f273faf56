"""Services of franka_control: settings, recovery, connection, contact budget of an arm.

Source: franka_ros@c11f000 franka_hw/src/services.cpp and
franka_control/src/franka_control_node.cpp; differs: all services of an arm are one
handle, called in the control thread, and a refusal raises an error with its reason.

Only a simulated arm offers buttons, pushes and faults (`ArmSimulation`): at a real arm
people press the user stop and the guiding buttons, and sensors fail by themselves.

The contact budget estimates the speed at which a contact with a person would stay below
a limit. It is not a safety function: it stops nothing, it is not certified, and the
masses of a real arm, its tool and its load are not known exactly. Source: ISO/TS
15066:2016, annex A: a contact of two masses through the spring of a body region,
F = v sqrt(mu k), with the reduced mass mu of both; differs: the mass of the robot is
the effective one along the direction, not half the mass of its moving parts.
"""
# ruff: noqa: N802, N803 - NE_T_EE, EE_T_K, F_x_center_load are libfranka's names.

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from station.core.franka.franka_errors import ArmError
from station.core.franka.franka_model import Frame, FrankaModelHandle
from station.core.franka.franka_robot_state import RobotMode, RobotState
from station.core.hardware.interfaces.resource_manager import HardwareResourceManager
from station.core.hardware.robot_report import ClampReport
from station.core.hardware.services import RecoverableRobot, ServiceKind, service
from station.reports import ArmRecord

# Speed below which the motion has no direction [m/s].
_AT_REST = 1e-3


class FaultKind(Enum):
    """The kinds of faults that can be injected into a simulation."""

    LOST_PACKETS = "lost_packets"
    """Commands do not reach the arm."""
    DELAYED_CYCLE = "delayed_cycle"
    """The loop's next cycle begins late: its period is longer, packets are lost."""
    NAN_SENSOR = "nan_sensor"
    """The measured position of a joint is not finite."""
    STUCK_JOINT = "stuck_joint"
    """A joint does not move."""
    COLLISION = "collision"
    """An object hits the hand."""


@dataclass(frozen=True, slots=True)
class SimulatedFault:
    """One fault to inject.

    Attributes:
        kind: Kind of the fault.
        cycles: Duration in cycles of the arm, >= 1.
        joint: Number of the joint, 1 to 7; ignored by kinds that concern no joint.
        force: Force of a collision in the base frame [N], shape (3,).
    """

    kind: FaultKind
    cycles: int
    joint: int = 1
    force: tuple[float, float, float] = (0.0, 0.0, -100.0)


class ArmSimulation(ABC):
    """The controls of one simulated arm. Control thread, between two cycles."""

    @abstractmethod
    def set_user_stop(self, *, pressed: bool) -> None:
        """Press or release the user stop; releasing it clears the arm's errors.

        Args:
            pressed: Whether the button is down from now on.
        """

    @abstractmethod
    def set_guiding(self, *, pressed: bool) -> None:
        """Press or release the guiding buttons; while pressed, the arm gives way.

        Args:
            pressed: Whether the buttons are down from now on.

        Raises:
            ArmCommandError: The buttons are to be pressed and the arm is not idle.
        """

    @abstractmethod
    def set_brakes(self, *, closed: bool) -> None:
        """Close or open the brakes of all joints; while closed, the mode is Other.

        Args:
            closed: Whether the joints are locked from now on; a motion ends.
        """

    @abstractmethod
    def set_state_precision(self, *, is_single: bool) -> None:
        """Set the precision in which whoever commands the arm sees its state.

        A command that continues a rounded state is off by its rounding, and so may be
        beyond a limit by that much.

        Args:
            is_single: Whether in single precision, and not in double.
        """

    @abstractmethod
    def apply_force(
        self,
        link: str,
        force: Sequence[float],
        torque: Sequence[float],
        duration: float,
        *,
        frame: str = "world",
        point: Sequence[float] | None = None,
    ) -> None:
        """Push a link of the arm, or another object of its world, for a while.

        Args:
            link: Name of the link or object.
            force: Force [N], shape (3,).
            torque: Torque [Nm], shape (3,).
            duration: Duration of the push [s], > 0.
            frame: Axes of `force` and `torque`: `world`, or the name of a link, whose
                axes turn with it.
            point: Point of application, in the link's frame [m], shape (3,); None for
                the link's centre of mass.

        Raises:
            HardwareInterfaceError: The world has no such link or object.
        """

    @abstractmethod
    def inject(self, fault: SimulatedFault) -> None:
        """Begin a fault; a running fault of the same kind and joint is replaced.

        A delayed cycle does not concern the arm: the control loop carries it out.

        Args:
            fault: The fault.

        Raises:
            InvalidCommandError: The fault lasts too long.
            HardwareInterfaceError: The arm has no part that a collision could hit.
        """

    @abstractmethod
    def faults(self) -> list[SimulatedFault]:
        """Return the active faults and pushes with their remaining cycles."""

    @abstractmethod
    def clear_faults(self) -> None:
        """End all faults and all pushes."""

    @abstractmethod
    def clamps(self) -> list[ClampReport]:
        """Return the joints that the simulation's own brakes have held. Any thread."""


@dataclass(frozen=True, slots=True)
class CollisionBehavior:
    """Thresholds of contact (lower) and collision (upper).

    Thresholds named `acceleration` apply while the desired motion accelerates, those
    named `nominal` otherwise. Torques [Nm], shape (7,); forces [N, Nm], shape (6,).
    """

    lower_torque_thresholds_acceleration: tuple[float, ...]
    upper_torque_thresholds_acceleration: tuple[float, ...]
    lower_torque_thresholds_nominal: tuple[float, ...]
    upper_torque_thresholds_nominal: tuple[float, ...]
    lower_force_thresholds_acceleration: tuple[float, ...]
    upper_force_thresholds_acceleration: tuple[float, ...]
    lower_force_thresholds_nominal: tuple[float, ...]
    upper_force_thresholds_nominal: tuple[float, ...]


class FrankaServices(RecoverableRobot):
    """The services of one arm, under its arm_id.

    `robot_mode`, `errors`, `near_errors`, `remedy` and `is_connected` may be called by
    any thread; the other methods belong to the control thread, between two cycles. The
    setters are refused while the arm moves, as a real arm refuses them.
    """

    @abstractmethod
    def robot_mode(self) -> RobotMode:
        """Return the mode of the arm."""

    @abstractmethod
    def get_robot_state(self) -> RobotState:
        """Return a copy of the state of the last cycle, all fields up to date."""

    @abstractmethod
    def model(self) -> FrankaModelHandle:
        """Return the arm's model."""

    @abstractmethod
    def errors(self) -> list[ArmError]:
        """Return the present errors; if none, those that ended the last motion."""

    @abstractmethod
    def near_errors(self) -> list[ArmError]:
        """Return the errors that a slightly larger force on the arm would raise."""

    @abstractmethod
    def log(self) -> list[ArmRecord]:
        """Return the last cycles before the last error, oldest first, at most 50."""

    @service(ServiceKind.QUERY)
    def contact_budget(self) -> dict[str, Any]:
        """Estimate the speeds at which a contact stays below a person's limits.

        The result has a speed for each body region, for the present pose and the
        direction in which the end effector moves; at rest, for the direction of the
        largest effective mass. It is an estimate and not a safety function.
        """
        model, state = self.model(), self.get_robot_state()
        jacobian = model.get_zero_jacobian(Frame.END_EFFECTOR)
        return contact_budget(model.get_mass(), jacobian, state.dq)

    @abstractmethod
    def simulation(self) -> ArmSimulation | None:
        """Return the controls that only a simulated arm has; None for a real arm."""

    @abstractmethod
    def is_connected(self) -> bool:
        """Return whether the arm is connected."""

    @service(ServiceKind.SETTING)
    @abstractmethod
    def set_joint_impedance(self, joint_stiffness: Sequence[float]) -> None:
        """Set the internal joint impedance; refused while the arm moves.

        Args:
            joint_stiffness: Stiffness of the joints [Nm/rad], 0 to 14250, shape (7,).

        Raises:
            InvalidCommandError: A value is out of range.
            ArmCommandError: The arm moves or is not connected, or `internal_controller`
                is set to another controller.
        """

    @service(ServiceKind.SETTING)
    @abstractmethod
    def set_cartesian_impedance(self, cartesian_stiffness: Sequence[float]) -> None:
        """Set the internal Cartesian impedance; refused while the arm moves.

        The axes are those of the stiffness frame. The impedance acts in motions of the
        end effector that begin after the call, until a joint impedance is set.

        Args:
            cartesian_stiffness: Three stiffnesses [N/m], 10 to 3000, then three
                [Nm/rad], 1 to 300.

        Raises:
            InvalidCommandError: A value is out of range.
            ArmCommandError: The arm moves or is not connected, or `internal_controller`
                is set to another controller.
        """

    @service(ServiceKind.SETTING)
    @abstractmethod
    def set_EE_frame(self, NE_T_EE: Sequence[float]) -> None:
        """Set the end effector frame; refused while the arm moves.

        The frame is given in the nominal end effector frame.

        Args:
            NE_T_EE: A homogeneous transform, 16 numbers.

        Raises:
            InvalidCommandError: The numbers are not a homogeneous transform.
            ArmCommandError: The arm moves or is not connected.
        """

    @service(ServiceKind.SETTING)
    @abstractmethod
    def set_K_frame(self, EE_T_K: Sequence[float]) -> None:
        """Set the stiffness frame; refused while the arm moves.

        The frame is given in the end effector frame.

        Args:
            EE_T_K: A homogeneous transform, 16 numbers.

        Raises:
            InvalidCommandError: The numbers are not a homogeneous transform.
            ArmCommandError: The arm moves or is not connected.
        """

    @service(ServiceKind.SETTING)
    @abstractmethod
    def set_load(
        self,
        mass: float,
        F_x_center_load: Sequence[float],
        load_inertia: Sequence[float],
    ) -> None:
        """Set the load that the hand holds; refused while the arm moves.

        The arm carries the weight of the load from now on.

        Args:
            mass: Mass [kg], 0 to the payload of the arm, which is 3 kg unless it is
                configured otherwise.
            F_x_center_load: Centre of mass in the flange frame [m], shape (3,).
            load_inertia: Inertia about the centre of mass in the axes of the flange
                [kg m^2], 9 numbers, column-major.

        Raises:
            InvalidCommandError: A value is out of range, or no body has such an
                inertia.
            ArmCommandError: The arm moves or is not connected.
        """

    @abstractmethod
    def set_collision_behavior(self, behavior: CollisionBehavior) -> None:
        """Set the thresholds of contact and collision.

        Args:
            behavior: The thresholds, each > 0; a lower one must not exceed its upper
                one.

        Raises:
            InvalidCommandError: A threshold is impossible.
            ArmCommandError: The arm moves or is not connected.
        """

    @override
    def is_recovering(self) -> bool:
        return self.robot_mode() is RobotMode.AUTOMATIC_ERROR_RECOVERY

    @override
    @abstractmethod
    def error_recovery(self) -> bool:
        """Clear the errors and return to Idle; no motion starts.

        The arm is in AutomaticErrorRecovery until it is at rest.

        Returns:
            Whether there was an error.

        Raises:
            ArmCommandError: The arm cannot recover itself now.
        """

    @service()
    @abstractmethod
    def connect(self) -> None:
        """Connect to the arm; refused when it is connected.

        The collision thresholds are the configured ones again.

        Raises:
            ArmCommandError: The arm is connected already.
        """

    @service()
    @abstractmethod
    def disconnect(self) -> None:
        """Disconnect from the arm, which holds its pose.

        Refused while a controller commands the arm.

        Raises:
            ArmCommandError: A controller commands the arm, or it is not connected.
        """


class FrankaServicesInterface(HardwareResourceManager[FrankaServices]):
    """Services of arms by arm_id."""

    type_name: ClassVar[str] = "franka_control::FrankaServicesInterface"


@dataclass(frozen=True, slots=True)
class BodyRegion:
    """A region of the human body.

    Attributes:
        force: Largest force of a transient contact [N].
        stiffness: Effective spring constant [N/m].
        mass: Effective mass [kg].
    """

    force: float
    stiffness: float
    mass: float


REGIONS = {
    "neck": BodyRegion(300.0, 50e3, 1.2),
    "back": BodyRegion(420.0, 35e3, 40.0),
    "chest": BodyRegion(280.0, 25e3, 40.0),
    "abdomen": BodyRegion(220.0, 10e3, 40.0),
    "pelvis": BodyRegion(360.0, 25e3, 40.0),
    "upper_arm": BodyRegion(300.0, 30e3, 3.0),
    "forearm": BodyRegion(320.0, 40e3, 2.0),
    "hand": BodyRegion(280.0, 75e3, 0.6),
    "thigh": BodyRegion(440.0, 50e3, 75.0),
    "shin": BodyRegion(260.0, 60e3, 75.0),
}
"""The body regions by name. Their forces are twice those of a quasi-static contact.
Skull and face have no permitted value.

Source: ISO/TS 15066:2016, tables A.2 and A.3, which are not public. The figures were
compared with published ones: springs and masses are those of
epfl-lasa/human-robot-collider, `collision.py`, for a person of 75 kg. Two further
programs have the same forces, except for the neck, for which one of them has 290 N. For
thigh and shin one program has masses of 8 and 4 kg; the 75 kg of the whole body, used
here, permit less speed.
"""


def contact_budget(
    mass: Sequence[float], jacobian: Sequence[float], dq: Sequence[float]
) -> dict[str, object]:
    """Return effective mass, speed, and the speed that each body region permits.

    Args:
        mass: Mass matrix [kg m^2], n n numbers.
        jacobian: Jacobian of the point of contact, 6 n numbers, column-major.
        dq: Joint velocities [rad/s], shape (n,).

    Returns:
        `direction`, the unit vector of the motion in the base frame, or at rest the
        direction of the largest effective mass; `effective_mass` along it [kg]; `speed`
        [m/s]; and for each body region the `speed` [m/s] up to which the force of a
        transient contact stays below `force` [N], and the `energy` [J] at this speed.
    """
    count = len(dq)
    j = np.array(jacobian, dtype=float).reshape(count, 6).T[:3]
    mobility = j @ np.linalg.solve(np.array(mass, dtype=float).reshape(count, -1), j.T)
    velocity = j @ np.array(dq, dtype=float)
    speed = float(np.linalg.norm(velocity))
    if speed > _AT_REST:
        direction = velocity / speed
    else:
        direction = np.linalg.eigh(mobility)[1][:, 0]
    effective = effective_mass(mobility, direction)
    regions = {
        name: _budget(effective, region) for name, region in sorted(REGIONS.items())
    }
    return {
        "direction": [float(one) for one in direction],
        "effective_mass": effective,
        "speed": speed,
        "regions": regions,
    }


def effective_mass(
    mobility: NDArray[np.float64], direction: NDArray[np.float64]
) -> float:
    """Return the mass that a push along a direction meets [kg].

    Args:
        mobility: J M^-1 J^T of the point [1/kg], shape (3, 3).
        direction: Unit vector, shape (3,).
    """
    return 1.0 / float(direction @ mobility @ direction)


def _budget(robot: float, region: BodyRegion) -> dict[str, float]:
    reduced = 1.0 / (1.0 / robot + 1.0 / region.mass)
    speed = region.force / float(np.sqrt(reduced * region.stiffness))
    energy = region.force**2 / (2.0 * region.stiffness)
    return {"speed": speed, "force": region.force, "energy": energy}
