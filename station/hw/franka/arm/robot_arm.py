"""The seam between FrankaHW and an arm, at the same place as libfranka's interface.

A real arm is another implementation of `RobotArm`.

Source: libfranka@0.9.2 include/franka/robot.h, Robot; differs: a motion is started and
stopped explicitly and commanded once per cycle, instead of by a blocking `control` with
callbacks, because the cycle belongs to the station's loop.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from enum import Enum

from station.core.errors import ArmCommandError
from station.core.franka.franka_errors import ArmError
from station.core.franka.franka_model import FrankaModel
from station.core.franka.franka_robot_state import RobotState
from station.core.franka.franka_services import ArmSimulation, CollisionBehavior
from station.core.franka.model_sources import ModelSource
from station.core.geometry.guard import Guard
from station.hw.franka.arm.receiver import Receiver
from station.hw.franka.arm.rigid_body import RigidBody
from station.memory.doubles import Doubles, Storage
from station.reports import ArmRecord

REST_VELOCITY = 2e-4
"""Speed below which joints count as at rest [rad/s]."""
MEASURED_REST = 0.02
"""Measured speed below which joints count as at rest [rad/s]: the noise of a real arm's
velocities is 3 mrad/s (see `Realism`)."""

MOST_LOST_PACKETS = 20
"""Number of commands lost in a row that ends a motion."""


class SingularStartError(ArmCommandError):
    """A Cartesian motion would begin at a singular pose."""


class ControllerMode(Enum):
    """The controller that computes the torques during a motion."""

    JOINT_IMPEDANCE = "joint_impedance"
    CARTESIAN_IMPEDANCE = "cartesian_impedance"
    EXTERNAL_CONTROLLER = "external_controller"


class MotionGeneratorMode(Enum):
    """The kind of motion that the client commands."""

    NONE = "none"
    JOINT_POSITION = "joint_position"
    JOINT_VELOCITY = "joint_velocity"
    CARTESIAN_POSITION = "cartesian_position"
    CARTESIAN_VELOCITY = "cartesian_velocity"


class RobotArm(ABC):
    """An arm with 7 joints that is read and commanded once per cycle.

    Order: `read_once` is called once per elapsed cycle. While a motion runs, the
    commands of its modes follow between two reads, each once per cycle; a command acts
    in the step to the next state. Before the first command of a motion the arm stays
    where it is. After it, a cycle without a command counts as a lost packet: the motion
    continues with constant acceleration, and `MOST_LOST_PACKETS` lost packets in a row
    end it with `communication_constraints_violation`. Without a motion the arm holds
    its pose itself.

    Threads: all methods belong to the control thread. `read_once` may wait for the
    arm's next state and for nothing else; `read_once`, `start_motion`, `stop_motion`
    and the `command_…` methods do not log, and do not raise once their arguments are
    valid.

    `station.testing.ArmConformance` tests that an implementation keeps this contract.

    Attributes:
        cycle_time: Time from one state of the arm to the next [s].
        state: The arm's state; one object for the life of the arm, see `RobotState`.
        guard: Keeps the arm clear of its scene; None without a scene. Code that
            commands the arm calls the guard first.
    """

    guard: Guard | None = None

    cycle_time: float
    state: RobotState

    @abstractmethod
    def read_once(self) -> RobotState:
        """Wait for the arm's next state and return `state`."""

    def receiver(self) -> Receiver:
        """Return the object that takes commands before the `command_…` methods."""
        return Receiver()

    @abstractmethod
    def refusal(
        self,
        controller_mode: ControllerMode,
        motion_generator_mode: MotionGeneratorMode,
    ) -> str | None:
        """Return the reason why a motion with these modes is refused. Any thread.

        None if the motion could start. A motion that still runs is no reason, because
        the caller stops it first.
        """

    @abstractmethod
    def is_at_rest(self) -> bool:
        """Return whether the arm and its desired motion both stand still."""

    def is_stopping(self) -> bool:
        """Return whether the arm refuses a motion because it still ends the last one.

        Always False for an arm that can begin a new motion at once.
        """
        return False

    @abstractmethod
    def start_motion(
        self,
        controller_mode: ControllerMode,
        motion_generator_mode: MotionGeneratorMode,
    ) -> None:
        """Begin a motion. Until its first command the arm stays where it is.

        Args:
            controller_mode: Controller that computes the torques.
            motion_generator_mode: Kind of the commanded motion; NONE only with the
                external controller, for torques without a motion.

        Raises:
            SingularStartError: The motion is Cartesian and the pose is singular.
            ArmCommandError: A motion runs already, the modes do not fit together, or
                the arm cannot move now.
        """

    @abstractmethod
    def stop_motion(self) -> None:
        """End the motion: slow down to rest and hold. Does nothing without a motion."""

    @abstractmethod
    def command_joint_torques(self, tau: Storage) -> None:
        """Command torques, shape (7,); the arm adds gravity compensation.

        Args:
            tau: Desired link-side torques without gravity [Nm].

        Raises:
            InvalidCommandError: The command is not 7 finite numbers.
            ArmCommandError: No motion with the external controller runs.
        """

    @abstractmethod
    def command_joint_positions(self, q: Storage) -> None:
        """Command positions, shape (7,).

        Args:
            q: Desired positions [rad].

        Raises:
            InvalidCommandError: The command is not 7 finite numbers.
            ArmCommandError: No joint position motion runs.
        """

    def plan_joint_positions(self, q: Storage, fastest: Sequence[float]) -> None:
        """Let the arm plan and execute a motion to positions by itself.

        One call is enough for the whole motion: the following cycles need no command.
        Another call changes the target at any time. A target beyond the limits is an
        error of the arm, as a commanded position would be.

        Args:
            q: Target positions [rad], shape (7,).
            fastest: Largest velocities, > 0 [rad/s], shape (7,); the arm's own limits
                apply, too.

        Raises:
            InvalidCommandError: `q` is not 7 finite numbers.
            ArmCommandError: No joint position motion runs, or the arm cannot plan.
        """
        raise ArmCommandError(
            f"The arm plans no way to {[*q]} within {[*fastest]} rad/s.",
            remedy="Command positions in every cycle.",
        )

    @abstractmethod
    def command_joint_velocities(self, dq: Storage) -> None:
        """Command velocities, shape (7,).

        Args:
            dq: Desired velocities [rad/s].

        Raises:
            InvalidCommandError: The command is not 7 finite numbers.
            ArmCommandError: No joint velocity motion runs.
        """

    @abstractmethod
    def command_cartesian_pose(
        self, pose: Storage, elbow: list[float] | None = None
    ) -> None:
        """Command the end effector's pose.

        Args:
            pose: Homogeneous transform O_T_EE, column-major, shape (16,) [-, m].
            elbow: Position of joint 3 [rad] and sign of joint 4 (+1 or -1), or None to
                let the arm choose the elbow.

        Raises:
            InvalidCommandError: `pose` is not a transform, or the elbow is impossible.
            ArmCommandError: No Cartesian position motion runs.
        """

    @abstractmethod
    def command_cartesian_velocity(
        self, twist: Storage, elbow: list[float] | None = None
    ) -> None:
        """Command the end effector's twist.

        Args:
            twist: O_dP_EE: linear [m/s], then angular velocity [rad/s], shape (6,).
            elbow: As in `command_cartesian_pose`.

        Raises:
            InvalidCommandError: A number is not finite, or the elbow is impossible.
            ArmCommandError: No Cartesian velocity motion runs.
        """

    @abstractmethod
    def load_model(self) -> FrankaModel:
        """Return a new model of the arm, after milliseconds; not during a motion.

        Source: libfranka@0.9.2 include/franka/robot.h, Robot.loadModel.
        """

    @abstractmethod
    def refresh_state(self) -> None:
        """Bring the derived fields of `state` up to date.

        This costs almost nothing if they are up to date already.
        """

    def pose_source(self, model: FrankaModel) -> ModelSource | None:  # noqa: ARG002
        """Return a source of `O_T_EE` that needs no refresh; None if there is none.

        Args:
            model: A model of this arm, whose results are reused if possible.
        """
        return None

    def accelerometers(self) -> tuple[Doubles, Doubles] | None:
        """Return the readings at the top and the bottom of the boards in the joints.

        None if the arm does not report them. They are computed only in this call, so
        that they cost no time otherwise.

        Returns:
            Top and bottom readings for the boards of joints 1 to 6, in the axes of the
            sensors, gravity included [m/s^2], each of 6 x 3 numbers; valid until the
            next call.
        """
        return None

    @abstractmethod
    def set_joint_impedance(self, stiffness: Sequence[float]) -> None:
        """Set the stiffness of the internal joint impedance controller.

        Args:
            stiffness: Stiffness of the joints [Nm/rad], > 0, shape (7,).

        Raises:
            ArmCommandError: A motion runs; the other setters raise this, too.
        """

    @abstractmethod
    def set_cartesian_impedance(self, stiffness: Sequence[float]) -> None:
        """Set the stiffness of the internal Cartesian impedance controller.

        Args:
            stiffness: Stiffness in the axes of the stiffness frame [N/m, Nm/rad], > 0,
                shape (6,).

        Raises:
            ArmCommandError: A motion runs.
        """

    @abstractmethod
    def set_end_effector_frame(self, frame: Sequence[float]) -> None:
        """Set the end effector in the nominal end effector frame.

        Args:
            frame: NE_T_EE, a homogeneous transform, 16 numbers.

        Raises:
            ArmCommandError: A motion runs.
        """

    @abstractmethod
    def set_stiffness_frame(self, frame: Sequence[float]) -> None:
        """Set the stiffness frame in the end effector frame.

        Args:
            frame: EE_T_K, a homogeneous transform, 16 numbers.

        Raises:
            ArmCommandError: A motion runs.
        """

    @abstractmethod
    def set_load(self, load: RigidBody) -> None:
        """Set the load that the end effector holds; the arm carries its weight.

        Args:
            load: The load.

        Raises:
            ArmCommandError: A motion runs.
        """

    @abstractmethod
    def set_collision_behavior(self, behavior: CollisionBehavior) -> None:
        """Set the thresholds of contact and collision.

        Args:
            behavior: The thresholds, > 0.

        Raises:
            ArmCommandError: A motion runs.
        """

    def collision_behavior(self) -> CollisionBehavior | None:
        """Return the thresholds in force; None if the arm does not report them."""
        return None

    def is_lost(self) -> bool:
        """Return whether there is no connection to the arm.

        A recovery connects again. A simulated arm is never lost.
        """
        return False

    @abstractmethod
    def check_recovery(self) -> None:
        """Refuse if the arm cannot recover itself now. An arm without errors can.

        Raises:
            ArmCommandError: The arm cannot recover, e.g. the user stop is pressed.
        """

    @abstractmethod
    def automatic_error_recovery(self) -> None:
        """Return from Reflex to Idle and forget the errors; no motion starts.

        The arm is in AutomaticErrorRecovery until it is at rest. If it is not in
        Reflex, nothing happens.

        Raises:
            ArmCommandError: The arm is in a state from which it cannot recover itself.
        """

    @abstractmethod
    def errors(self) -> list[ArmError]:
        """Return the present errors; if none, those that ended the last motion."""

    def failure(self) -> str:
        """Return the arm's message about the end of its last motion; may be empty."""
        return ""

    @abstractmethod
    def log(self) -> list[ArmRecord]:
        """Return the last cycles before the last error, oldest first, at most 50."""

    @abstractmethod
    def remedy(self) -> str | None:
        """Return the step needed before the arm can move; None if it can move."""

    @abstractmethod
    def simulation(self) -> ArmSimulation | None:
        """Return the controls that only a simulated arm has; None for a real arm."""
