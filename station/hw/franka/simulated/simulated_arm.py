"""A Franka arm simulated in a MuJoCo world, with the arm's protective functions."""

from collections.abc import Sequence

from typing_extensions import override

from station.core.description.robot_files import RobotFiles
from station.core.franka.franka_errors import ArmError
from station.core.franka.franka_model import Frame, FrankaModel
from station.core.franka.franka_robot_state import RobotMode, RobotState
from station.core.franka.franka_services import ArmSimulation, CollisionBehavior
from station.core.franka.model_sources import ModelSource
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.franka.arm.robot_arm import (
    ControllerMode,
    MotionGeneratorMode,
    RobotArm,
)
from station.hw.franka.arm.service_limits import ServiceLimits
from station.hw.franka.simulated.accelerometers import Accelerometers
from station.hw.franka.simulated.arm_model import ArmModel
from station.hw.franka.simulated.arm_modes import ArmModes
from station.hw.franka.simulated.arm_parts import ArmParts
from station.hw.franka.simulated.arm_step import StepReceiver
from station.hw.mujoco.world import World
from station.memory.direct_calls import call_directly
from station.memory.doubles import Doubles, Storage
from station.reports import ArmRecord

_ZEROS = [0.0] * 7


class SimulatedArm(RobotArm):
    """An arm in a `World`; several arms may share one.

    The world makes a step when one of its arms asks for a state after the present one.
    So arms that are all read once per cycle stay in step.

    A motion under torque control starts from rest: the internal controller first brings
    a moving arm to rest, and only then the torques act.

    Args:
        world: The world, with gravity compensation for this arm.
        parts: Parts of the arm.
        description: The URDF of the arm.
        service_limits: The largest pushes.

    Attributes:
        limits: Limits of this kind of arm.
        frames: Frames and derived state.
        motors: The motors and the internal controllers.
        load: The configured load.
        contact: External torques and the thresholds for them.
        supervisor: Finds and keeps the errors.
    """

    def __init__(
        self,
        world: World,
        parts: ArmParts,
        description: RobotFiles,
        service_limits: ServiceLimits,
    ) -> None:
        self._world, self._description = world, description
        self.cycle_time = world.timestep
        self.state, self.limits = parts.state, parts.limits
        self.frames, self.load = parts.frames, parts.load
        self.motors, self.contact = parts.motors, parts.contact
        self.supervisor = parts.supervisor
        self._faults = parts.faults
        self._motion, self._memory = parts.motion, parts.memory
        self._modes = ArmModes(world, parts, service_limits)
        self._step = parts.step
        self._step.modes = self._modes
        self._accelerometers = Accelerometers(self.state, self._memory)
        call_directly(self, SimulatedArm, read_once=self._step.read_state)
        self.after_reset()
        # Preparations run in the order in which they are added: friction acts first.
        if self.contact.observer is not None:
            world.add_preparation(self.contact.observer)
        world.add_actor(self, self._step)

    @override
    def read_once(self) -> RobotState:
        return self._step.read_state()

    @override
    def receiver(self) -> StepReceiver:
        return StepReceiver(self._step)

    @override
    def load_model(self) -> FrankaModel:
        return ArmModel(self._description)

    @override
    def refresh_state(self) -> None:
        if self.frames.refresh():
            self.motors.differentiate()

    @override
    def pose_source(self, model: FrankaModel) -> ModelSource:
        q, tool, stiffness_frame = map(self.state.doubles, ("q", "F_T_EE", "EE_T_K"))
        return model.pose_source(Frame.END_EFFECTOR, q, tool, stiffness_frame)

    @override
    def accelerometers(self) -> tuple[Doubles, Doubles]:
        return self._accelerometers.read()

    @override
    def refusal(
        self,
        controller_mode: ControllerMode,
        motion_generator_mode: MotionGeneratorMode,
    ) -> str | None:
        return self._modes.refusal(controller_mode, motion_generator_mode)

    @override
    def is_at_rest(self) -> bool:
        return self._modes.is_at_rest()

    @override
    def start_motion(
        self,
        controller_mode: ControllerMode,
        motion_generator_mode: MotionGeneratorMode,
    ) -> None:
        self._modes.begin_motion(controller_mode, motion_generator_mode)

    @override
    def stop_motion(self) -> None:
        if self.state.robot_mode is RobotMode.MOVE:
            self._modes.end_motion(RobotMode.IDLE)

    @override
    def command_joint_torques(self, tau: Storage) -> None:
        if self._modes.controller is not ControllerMode.EXTERNAL_CONTROLLER:
            raise self._modes.not_commandable("joint torques")
        self._step.command_torques(tau)

    @override
    def command_joint_positions(self, q: Storage) -> None:
        if self._modes.generator is not MotionGeneratorMode.JOINT_POSITION:
            raise self._modes.not_commandable("joint positions")
        self._step.command_joints(q)

    @override
    def plan_joint_positions(self, q: Storage, fastest: Sequence[float]) -> None:
        if self._modes.generator is not MotionGeneratorMode.JOINT_POSITION:
            raise self._modes.not_commandable("joint positions")
        self._step.plan_joints(q, fastest)

    @override
    def command_joint_velocities(self, dq: Storage) -> None:
        if self._modes.generator is not MotionGeneratorMode.JOINT_VELOCITY:
            raise self._modes.not_commandable("joint velocities")
        self._step.command_joints(dq)

    @override
    def command_cartesian_pose(
        self, pose: Storage, elbow: list[float] | None = None
    ) -> None:
        if self._modes.generator is not MotionGeneratorMode.CARTESIAN_POSITION:
            raise self._modes.not_commandable("Cartesian pose")
        self._step.command_cartesian(pose, elbow, 16)

    @override
    def command_cartesian_velocity(
        self, twist: Storage, elbow: list[float] | None = None
    ) -> None:
        if self._modes.generator is not MotionGeneratorMode.CARTESIAN_VELOCITY:
            raise self._modes.not_commandable("Cartesian velocity")
        self._step.command_cartesian(twist, elbow, 6)

    @override
    def set_joint_impedance(self, stiffness: Sequence[float]) -> None:
        self._modes.refuse_while_moving("joint impedance")
        self.motors.joint_stiffness = list(stiffness)
        self.motors.engage_joint_impedance()

    @override
    def set_cartesian_impedance(self, stiffness: Sequence[float]) -> None:
        self._modes.refuse_while_moving("Cartesian impedance")
        self.motors.cartesian_stiffness = list(stiffness)

    @override
    def set_end_effector_frame(self, frame: Sequence[float]) -> None:
        self._modes.refuse_while_moving("end effector frame")
        self.frames.set_frame(frame)
        self.contact.renew()

    def set_mounted(
        self, end_effector: RigidBody, nominal_frame: Sequence[float]
    ) -> None:
        """Report another end effector in the state; the simulated bodies do not change.

        Args:
            end_effector: Mass properties of the end effector.
            nominal_frame: F_T_NE, 16 numbers.

        Raises:
            ArmCommandError: A motion runs.
        """
        self._modes.refuse_while_moving("end effector")
        self.frames.set_end_effector(end_effector, nominal_frame)
        self.contact.renew()

    @override
    def set_stiffness_frame(self, frame: Sequence[float]) -> None:
        self._modes.refuse_while_moving("stiffness frame")
        self.frames.set_stiffness_frame(frame)
        self.contact.renew()

    @override
    def set_load(self, load: RigidBody) -> None:
        self._modes.refuse_while_moving("load")
        self.frames.set_load(load)
        self.load.load = load
        self._step.has_load = bool(load.mass)
        self._step.expect_load()
        self.motors.carry(_ZEROS)

    @override
    def set_collision_behavior(self, behavior: CollisionBehavior) -> None:
        self._modes.refuse_while_moving("collision behaviour")
        self.contact.set_behavior(behavior)

    @override
    def collision_behavior(self) -> CollisionBehavior:
        return self.contact.behavior

    @override
    def check_recovery(self) -> None:
        self._modes.check_recovery()

    @override
    def automatic_error_recovery(self) -> None:
        self._modes.check_recovery()
        if self.state.robot_mode is RobotMode.REFLEX:
            self._modes.recover()

    @override
    def errors(self) -> list[ArmError]:
        return list(self.supervisor.errors or self.supervisor.last_motion_errors)

    @override
    def log(self) -> list[ArmRecord]:
        return list(self.supervisor.log)

    @override
    def remedy(self) -> str | None:
        return self._modes.remedy()

    @override
    def simulation(self) -> ArmSimulation:
        return self._modes

    def after_reset(self) -> None:
        """Read the pose to which the world was set, with all velocities zero.

        A running motion continues with its next command.
        """
        state = self.state
        self._step.read_rest()
        self._accelerometers.forget()
        self._motion.seed(self._memory.positions, _ZEROS)
        self.motors.engage_joint_impedance()
        # A running motion continues after a reset, with its own controller.
        if self._modes.controller is ControllerMode.CARTESIAN_IMPEDANCE:
            self.motors.engage_cartesian_impedance()
        self._faults.clear()
        self._step.has_faults = False
        self.contact.reset()
        self.supervisor.expect_new_pose()
        self._modes.expect_command()
        self._step.read_joints()
        if self.contact.observer is not None:
            self.contact.observer.settle_elasticity()
        self.frames.invalidate()
        if state.robot_mode in (RobotMode.OTHER, RobotMode.GUIDING):
            state.robot_mode = RobotMode.IDLE
