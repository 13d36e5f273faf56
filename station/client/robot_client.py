"""The synchronous client of one arm: one method per route."""
# ruff: noqa: N802, N803 - NE_T_EE, F_x_center_load and so on are libfranka's names.

from collections.abc import Callable, Sequence
from typing import Any

from station.client import robot_calls as calls
from station.client.calls import Call
from station.client.gripper_client import GripperClient
from station.client.robot_calls import Restart
from station.wire import (
    ActiveFault,
    ArmLog,
    ArmModel,
    ArmRecord,
    ArmReport,
    CartesianImpedance,
    EndEffectorFrame,
    ExternalForce,
    Fault,
    Faults,
    ForceTorqueCollisionBehavior,
    FrameName,
    FrankaState,
    FullCollisionBehavior,
    JointImpedance,
    Load,
    Recovery,
    StiffnessFrame,
)


class RobotClient:
    """One arm of a station; made by `StationClient.robot`.

    Every method raises what the client's own methods raise.

    Args:
        do: Sends a call and returns its answer.
        arm_id: The arm.

    Attributes:
        arm_id: The arm.
        gripper: Its gripper.
    """

    def __init__(self, do: Callable[[Call[Any]], Any], arm_id: str) -> None:
        self._do = do
        self.arm_id = arm_id
        self.gripper = GripperClient(do, arm_id)

    def state(self) -> FrankaState:
        """Return the whole state."""
        answer: FrankaState = self._do(calls.state(self.arm_id))
        return answer

    def model(self, frame: FrameName = "end_effector") -> ArmModel:
        """Return mass, Coriolis, gravity, and the pose and Jacobians of a frame."""
        answer: ArmModel = self._do(calls.model(self.arm_id, frame))
        return answer

    def errors(self) -> ArmReport:
        """Return mode and errors, and what to do."""
        answer: ArmReport = self._do(calls.errors(self.arm_id))
        return answer

    def log(self) -> list[ArmRecord]:
        """Return the last cycles before the last error, oldest first."""
        answer: ArmLog = self._do(calls.log(self.arm_id))
        return answer.records

    def recover(self, restart: Restart = "none") -> Recovery:
        """Clear the errors; with `previous` start the stopped controllers again."""
        answer: Recovery = self._do(calls.recover(self.arm_id, restart))
        return answer

    def user_stop(self, *, pressed: bool) -> ArmReport:
        """Press or release the user stop."""
        answer: ArmReport = self._do(calls.user_stop(self.arm_id, pressed=pressed))
        return answer

    def guiding(self, *, pressed: bool) -> ArmReport:
        """Hold or let go of the guiding buttons; in simulation only."""
        answer: ArmReport = self._do(calls.guiding(self.arm_id, pressed=pressed))
        return answer

    def connect(self) -> ArmReport:
        """Connect to the arm."""
        answer: ArmReport = self._do(calls.act(self.arm_id, "connect"))
        return answer

    def disconnect(self) -> ArmReport:
        """Give the arm up."""
        answer: ArmReport = self._do(calls.act(self.arm_id, "disconnect"))
        return answer

    def set_joint_impedance(self, joint_stiffness: Sequence[float]) -> ArmReport:
        """Set the internal joint impedance [Nm/rad], shape (7,)."""
        answer: ArmReport = self._do(
            calls.send(
                "PUT",
                self.arm_id,
                "joint_impedance",
                JointImpedance(joint_stiffness=list(joint_stiffness)),
            )
        )
        return answer

    def set_cartesian_impedance(
        self, cartesian_stiffness: Sequence[float]
    ) -> ArmReport:
        """Set the internal Cartesian impedance [N/m, Nm/rad], shape (6,)."""
        answer: ArmReport = self._do(
            calls.send(
                "PUT",
                self.arm_id,
                "cartesian_impedance",
                CartesianImpedance(cartesian_stiffness=list(cartesian_stiffness)),
            )
        )
        return answer

    def set_EE_frame(self, NE_T_EE: Sequence[float]) -> ArmReport:
        """Set the end effector frame, 16 numbers, column-major."""
        answer: ArmReport = self._do(
            calls.send(
                "PUT", self.arm_id, "ee_frame", EndEffectorFrame(NE_T_EE=list(NE_T_EE))
            )
        )
        return answer

    def set_K_frame(self, EE_T_K: Sequence[float]) -> ArmReport:
        """Set the stiffness frame, 16 numbers, column-major."""
        answer: ArmReport = self._do(
            calls.send(
                "PUT", self.arm_id, "k_frame", StiffnessFrame(EE_T_K=list(EE_T_K))
            )
        )
        return answer

    def set_load(self, load: Load) -> ArmReport:
        """Set what the hand holds."""
        answer: ArmReport = self._do(calls.send("PUT", self.arm_id, "load", load))
        return answer

    def set_force_torque_collision_behavior(
        self, behavior: ForceTorqueCollisionBehavior
    ) -> ArmReport:
        """Set the thresholds of contact and collision of every phase."""
        answer: ArmReport = self._do(
            calls.send("PUT", self.arm_id, "force_torque_collision_behavior", behavior)
        )
        return answer

    def set_full_collision_behavior(self, behavior: FullCollisionBehavior) -> ArmReport:
        """Set the thresholds of contact and collision of both phases."""
        answer: ArmReport = self._do(
            calls.send("PUT", self.arm_id, "full_collision_behavior", behavior)
        )
        return answer

    def apply_force(self, push: ExternalForce) -> ArmReport:
        """Push a link; in simulation only."""
        answer: ArmReport = self._do(
            calls.send("POST", self.arm_id, "external_force", push)
        )
        return answer

    def inject(self, fault: Fault) -> ArmReport:
        """Make something go wrong; in simulation only."""
        answer: ArmReport = self._do(calls.send("POST", self.arm_id, "faults", fault))
        return answer

    def faults(self) -> list[ActiveFault]:
        """Return what was made to go wrong and lasts; in simulation only."""
        answer: Faults = self._do(calls.faults(self.arm_id))
        return answer.faults

    def clear_faults(self) -> list[ActiveFault]:
        """End what was made to go wrong, and every push; in simulation only."""
        answer: Faults = self._do(calls.clear_faults(self.arm_id))
        return answer.faults
