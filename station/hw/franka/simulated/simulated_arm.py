"""A Franka arm simulated in a MuJoCo world, with the arm's own safety around it."""

from collections.abc import Sequence

from typing_extensions import override

from station.core.errors import ArmCommandError
from station.core.franka.arm_simulation import ArmSimulation, SimulatedFault
from station.core.franka.franka_errors import ArmError
from station.core.franka.franka_model import GRAVITY_EARTH
from station.core.franka.franka_robot_state import RobotMode, RobotState
from station.hw.franka.arm.arm_limits import PANDA_LIMITS, ArmLimits
from station.hw.franka.arm.robot_arm import (
    REST_VELOCITY,
    ControllerMode,
    MotionGeneratorMode,
)
from station.hw.franka.simulated.arm_frames import ArmFrames
from station.hw.franka.simulated.arm_load import ArmLoad
from station.hw.franka.simulated.arm_motors import ArmMotors
from station.hw.franka.simulated.arm_recovery import HALTED, ArmRecovery
from station.hw.franka.simulated.arm_supervisor import ArmSupervisor, SupervisorLimits
from station.hw.franka.simulated.contact_estimate import ContactEstimate
from station.hw.franka.simulated.desired_motion import DesiredMotion
from station.hw.franka.simulated.motion_follower import (
    CARTESIAN_GENERATORS,
    MotionFollower,
)
from station.hw.franka.simulated.sensor_faults import SensorFaults
from station.hw.mujoco.push import WORLD, as_push
from station.hw.mujoco.world import World

# Torque control begins at rest, or so long after the desired motion has ended [s].
_LONGEST_SETTLING = 0.5
# What a hand that guides the arm feels [Nm s/rad].
_GUIDING_DAMPING = (10.0, 10.0, 10.0, 10.0, 1.0, 1.0, 1.0)
_ZEROS = [0.0] * 7
_INTERNAL_CONTROLLERS = (
    ControllerMode.JOINT_IMPEDANCE,
    ControllerMode.CARTESIAN_IMPEDANCE,
)
_SUPERVISED = (
    RobotMode.IDLE,
    RobotMode.MOVE,
    RobotMode.AUTOMATIC_ERROR_RECOVERY,
)


class SimulatedArm(ArmRecovery, ArmSimulation):
    """An arm in a `World`; several arms may share one.

    The world makes a step when the first of its arms asks for a state that it has not
    reached yet, so arms that are all read once per cycle stay in lockstep.

    A motion under torque control starts from rest: while the arm still moves it is
    slowed down by the internal controller first, and torques act thereafter.

    Args:
        world: The world, with gravity compensation for this arm.
        joint_names: The arm's 7 joints in that world, from base to flange.
        load: What a configured load needs.
        limits: Limits of this kind of arm.
        thresholds: Thresholds that Franka does not publish.
        hand: Body that a simulated collision hits.
        gravity: Acceleration of gravity in the base frame [m/s^2], shape (3,).
        damping_ratio: Damping ratio of the internal controllers, > 0.

    Attributes:
        frames: Frames and derived state.
        supervisor: The errors and where they came from.
    """

    def __init__(
        self,
        world: World,
        joint_names: Sequence[str],
        *,
        load: ArmLoad,
        limits: ArmLimits = PANDA_LIMITS,
        thresholds: SupervisorLimits | None = None,
        hand: str = "",
        gravity: Sequence[float] = GRAVITY_EARTH,
        damping_ratio: float = 1.0,
    ) -> None:
        self.cycle_time = world.timestep
        state = self.state = RobotState()
        state.O_ddP_O[:] = gravity
        self.limits = limits
        self._world = world
        self._joints = world.joints(joint_names)
        self._motion = DesiredMotion(
            state.q_d,
            state.dq_d,
            state.ddq_d,
            lower=list(limits.lower),
            upper=list(limits.upper),
            deceleration=list(limits.acceleration),
            period=world.timestep,
        )
        self._follower = MotionFollower(state, self._motion, limits, world.timestep)
        self.motors = ArmMotors(self._joints, state, damping_ratio)
        self.load = load
        self.frames = ArmFrames(state)
        self.supervisor = ArmSupervisor(
            state, limits, thresholds or SupervisorLimits(), world.timestep
        )
        self.supervisor.has_hand = hand.endswith("_hand")
        self.contact = ContactEstimate(self._joints, state, limits, self._load_torques)
        self._faults = SensorFaults(world, self._joints, hand)
        self._controller: ControllerMode | None = None
        self._generator = MotionGeneratorMode.NONE
        self._settling_time = 0.0
        self._ddq = _ZEROS
        self._cycle = world.step_count
        self._cycle_of_state = world.step_count
        self.after_reset()
        world.add_actor(self)

    @override
    def read_once(self) -> RobotState:
        self._cycle += 1
        world = self._world
        while world.step_count < self._cycle:
            world.step()
        if self._cycle_of_state < world.step_count:
            self._cycle_of_state = world.step_count
            self._update_state()
            self._supervise()
        return self.state

    @override
    def refresh_state(self) -> None:
        self.frames.refresh()

    @override
    def refusal(
        self,
        controller_mode: ControllerMode,
        motion_generator_mode: MotionGeneratorMode,
    ) -> str:
        mode = self.state.robot_mode
        if self._world.diverged_because:
            return f"{self._world.diverged_because}; {self.remedy()}"
        if mode in HALTED:
            return f"the arm is in mode {mode.name.lower()}; {self.remedy()}"
        is_external = controller_mode is ControllerMode.EXTERNAL_CONTROLLER
        if motion_generator_mode is MotionGeneratorMode.NONE and not is_external:
            return "the internal controller needs a motion generator"
        return ""

    @override
    def is_at_rest(self) -> bool:
        return self._motion.is_at_rest and self._speed() < REST_VELOCITY

    @override
    def start_motion(
        self,
        controller_mode: ControllerMode,
        motion_generator_mode: MotionGeneratorMode,
    ) -> None:
        reason = self.refusal(controller_mode, motion_generator_mode)
        if self.state.robot_mode is RobotMode.MOVE:
            reason = "a motion runs already"
        if reason:
            raise ArmCommandError(
                f"cannot start a motion: {reason}",
                remedy="stop the running motion, recover, or ask for other modes",
            )
        self._controller = controller_mode
        self._generator = motion_generator_mode
        self._settling_time = 0.0
        self._follower.begin(motion_generator_mode)
        self.supervisor.begin_motion()
        self.frames.is_cartesian = motion_generator_mode in CARTESIAN_GENERATORS
        if controller_mode is ControllerMode.CARTESIAN_IMPEDANCE:
            self.motors.engage_cartesian_impedance()
        self.state.robot_mode = RobotMode.MOVE
        self.state.control_command_success_rate = 1.0

    @override
    def stop_motion(self) -> None:
        if self.state.robot_mode is RobotMode.MOVE:
            self._end_motion(RobotMode.IDLE)

    @override
    def command_joint_torques(self, tau: list[float]) -> None:
        if self._controller is not ControllerMode.EXTERNAL_CONTROLLER:
            raise self._not_commandable("joint torques")
        self._follower.command_torques(tau)

    @override
    def command_joint_positions(self, q: list[float]) -> None:
        if self._generator is not MotionGeneratorMode.JOINT_POSITION:
            raise self._not_commandable("joint positions")
        self._follower.command_joints(q)

    @override
    def command_joint_velocities(self, dq: list[float]) -> None:
        if self._generator is not MotionGeneratorMode.JOINT_VELOCITY:
            raise self._not_commandable("joint velocities")
        self._follower.command_joints(dq)

    @override
    def command_cartesian_pose(
        self, pose: list[float], elbow: list[float] | None = None
    ) -> None:
        if self._generator is not MotionGeneratorMode.CARTESIAN_POSITION:
            raise self._not_commandable("a Cartesian pose")
        self._follower.command_cartesian(pose, elbow, 16)

    @override
    def command_cartesian_velocity(
        self, twist: list[float], elbow: list[float] | None = None
    ) -> None:
        if self._generator is not MotionGeneratorMode.CARTESIAN_VELOCITY:
            raise self._not_commandable("a Cartesian velocity")
        self._follower.command_cartesian(twist, elbow, 6)

    @override
    def simulation(self) -> ArmSimulation | None:
        return self

    @override
    def inject(self, fault: SimulatedFault) -> None:
        self._faults.inject(fault)

    @override
    def faults(self) -> list[SimulatedFault]:
        return self._faults.active()

    @override
    def clear_faults(self) -> None:
        self._faults.clear()

    @override
    def apply_force(
        self,
        link: str,
        force: Sequence[float],
        torque: Sequence[float],
        duration: float,
        *,
        frame: str = WORLD,
        point: Sequence[float] | None = None,
    ) -> None:
        push = as_push(link, force, torque, frame=frame, point=point)
        self._world.push(push, max(1, round(duration / self.cycle_time)))

    def before_step(self) -> None:
        """Take the commands, advance the desired motion, set the motors' controls."""
        motors = self.motors
        wants_torques = self._controller is ControllerMode.EXTERNAL_CONTROLLER
        if wants_torques and not motors.torques_act and self._motion.is_at_rest:
            self._let_torques_act_when_settled()
        if self.load.load.mass:
            motors.load_weight = self.load.weight(self.state.theta)
        self._faults.before_step()
        mode = self.state.robot_mode
        if mode is RobotMode.GUIDING:
            self._motion.seed(self.state.theta, self.state.dtheta)
            motors.apply_torques([
                -d * dq
                for d, dq in zip(_GUIDING_DAMPING, self.state.dtheta, strict=True)
            ])
            return
        if mode is not RobotMode.MOVE:
            self._motion.hold()
            if mode is RobotMode.AUTOMATIC_ERROR_RECOVERY:
                self._finish_recovery()
        elif wants_torques is not motors.torques_act:
            self._follower.ignore()
        else:
            self._follow()
        if motors.torques_act:
            motors.apply_torques(self._follower.torques)
        else:
            motors.apply_impedance(self.state.theta, self.state.dtheta)

    def after_reset(self) -> None:
        """Take over the pose that the world was set to, at rest.

        A running motion goes on; it waits for its next command.
        """
        state = self.state
        state.dq[:] = state.dtheta[:] = _ZEROS
        state.q[:] = state.theta[:] = self._joints.read_positions()
        self._motion.seed(state.theta, _ZEROS)
        self.motors.engage_joint_impedance()
        if self._controller is ControllerMode.CARTESIAN_IMPEDANCE:
            self.motors.engage_cartesian_impedance()
        self._faults.clear()
        self.contact.reset()
        self.supervisor.look_again()
        self._follower.begin(self._generator)
        self._update_state()
        self.frames.invalidate()
        if state.robot_mode in (RobotMode.OTHER, RobotMode.GUIDING):
            state.robot_mode = RobotMode.IDLE

    def _follow(self) -> None:
        """Advance the desired motion with the client's command; abort it on errors."""
        errors = self._follower.advance(
            torques_act=self.motors.torques_act,
            is_lossy=self._faults.loses_packet(),
        )
        if errors:
            self._reflex(errors)
            self._motion.hold()
        elif self._follower.is_begun:
            self.supervisor.record(self._follower.command)

    def _reflex(self, errors: Sequence[ArmError]) -> None:
        """Raise errors: end the motion and hold where the arm is."""
        self.supervisor.set_errors(errors, self._world.step_count)
        self._end_motion(RobotMode.REFLEX)

    @override
    def _end_motion(self, mode: RobotMode) -> None:
        state = self.state
        was_moving = state.robot_mode is RobotMode.MOVE
        state.robot_mode = mode
        if was_moving:
            self.supervisor.end_motion()
        if self.motors.torques_act or mode is not RobotMode.IDLE:
            self._motion.seed(state.theta, state.dtheta)
        self.motors.engage_joint_impedance()
        self._controller = None
        self._generator = MotionGeneratorMode.NONE
        self.frames.is_cartesian = False
        state.tau_J_d[:] = _ZEROS
        state.control_command_success_rate = 0.0

    def _let_torques_act_when_settled(self) -> None:
        self._settling_time += self.cycle_time
        if self._speed() < REST_VELOCITY or self._settling_time > _LONGEST_SETTLING:
            self.motors.engage_torques()

    def _speed(self) -> float:
        return max(map(abs, self.state.dtheta))

    def _update_state(self) -> None:
        state, joints = self.state, self._joints
        self.motors.read_torques(state.dtheta, self.cycle_time)
        dq = joints.read_velocities()
        if self.load.load.mass:
            self._ddq = [
                (new - old) / self.cycle_time
                for new, old in zip(dq, state.dtheta, strict=True)
            ]
        state.q[:] = state.theta[:] = joints.read_positions()
        state.dq[:] = state.dtheta[:] = dq
        state.time = self._cycle_of_state * self.cycle_time
        self._faults.disturb(state)
        if self._world.diverged_because and state.robot_mode is not RobotMode.OTHER:
            self._end_motion(RobotMode.OTHER)

    def _supervise(self) -> None:
        errors = self.contact.update()
        if self.state.robot_mode in _SUPERVISED:
            errors = errors + self.supervisor.measured_errors(
                self.state.theta, is_following=self._is_following()
            )
            if errors:
                self._reflex(errors)

    def _is_following(self) -> bool:
        """Tell whether the arm itself follows a desired motion."""
        return self._controller in _INTERNAL_CONTROLLERS

    def _load_torques(self) -> list[float] | None:
        if not self.load.load.mass:
            return None
        state = self.state
        return self.load.torques(state.theta, state.dtheta, self._ddq)

    def _not_commandable(self, what: str) -> ArmCommandError:
        controller = self._controller.value if self._controller else "none"
        return ArmCommandError(
            f"cannot command {what}: the arm is in mode {self.state.robot_mode.name}, "
            f"controller {controller}, motion generator {self._generator.value}",
            remedy="start a motion with the fitting modes first",
        )
