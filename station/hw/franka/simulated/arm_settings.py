"""The settings of a simulated arm: impedances, frames, load, thresholds."""

from collections.abc import Sequence

from typing_extensions import override

from station.core.errors import ArmCommandError
from station.core.franka.franka_robot_state import RobotMode
from station.core.franka.franka_services import CollisionBehavior
from station.hw.franka.arm.load import Load
from station.hw.franka.arm.robot_arm import RobotArm
from station.hw.franka.simulated.arm_frames import ArmFrames
from station.hw.franka.simulated.arm_load import ArmLoad
from station.hw.franka.simulated.arm_motors import ArmMotors
from station.hw.franka.simulated.contact_estimate import ContactEstimate


class ArmSettings(RobotArm):
    """The setters of a simulated arm; all are refused while it moves.

    Attributes:
        frames: Frames and derived state.
        load: What a configured load needs.
        motors: The motors and the internal controllers.
        contact: External torques and the thresholds for them.
    """

    frames: ArmFrames
    load: ArmLoad
    motors: ArmMotors
    contact: ContactEstimate

    @override
    def set_joint_impedance(self, stiffness: Sequence[float]) -> None:
        self._refuse_while_moving("the joint impedance")
        self.motors.joint_stiffness = list(stiffness)
        self.motors.engage_joint_impedance()

    @override
    def set_cartesian_impedance(self, stiffness: Sequence[float]) -> None:
        self._refuse_while_moving("the Cartesian impedance")
        self.motors.cartesian_stiffness = list(stiffness)

    @override
    def set_end_effector_frame(self, frame: Sequence[float]) -> None:
        self._refuse_while_moving("the end effector frame")
        self.frames.set_frame(frame)

    @override
    def set_stiffness_frame(self, frame: Sequence[float]) -> None:
        self._refuse_while_moving("the stiffness frame")
        self.frames.set_stiffness_frame(frame)

    @override
    def set_load(self, load: Load) -> None:
        self._refuse_while_moving("the load")
        self.frames.set_load(load)
        self.load.load = load
        self.motors.load_weight = [0.0] * 7

    @override
    def set_collision_behavior(self, behavior: CollisionBehavior) -> None:
        self._refuse_while_moving("the collision behaviour")
        self.contact.behavior = behavior

    def _refuse_while_moving(self, what: str) -> None:
        if self.state.robot_mode is RobotMode.MOVE:
            raise ArmCommandError(
                f"{what} cannot be changed while a motion runs",
                remedy="stop the controllers of this arm first",
            )
