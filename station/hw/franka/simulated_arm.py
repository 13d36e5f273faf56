"""A Franka arm simulated in a MuJoCo world.

Torques: the motors give the commanded torque, or that of the internal joint impedance

    tau = K (q_d - q) + D (dq_d - dq) + M_ii ddq_d + coriolis(q, dq)
    D = 2 zeta sqrt(K M_ii)

with M_ii the inertia at each joint, in D that when the impedance starts to act. What
depends on q and dq lives in the motors, where the integrator treats D implicitly.
Gravity is compensated in the world besides. Motors saturate at the effort limits.
"""

from collections.abc import Sequence
from math import isfinite, sqrt

from typing_extensions import override

from station.core.errors import InvalidCommandError
from station.hw.franka.desired_motion import DesiredMotion
from station.hw.franka.robot_arm import (
    ArmCommandError,
    ControllerMode,
    MotionGeneratorMode,
    RobotArm,
)
from station.hw.franka.robot_state import RobotMode, RobotState
from station.hw.mujoco.world import World

DEFAULT_JOINT_IMPEDANCE = (3000.0, 3000.0, 3000.0, 2500.0, 2500.0, 2000.0, 2000.0)
"""Stiffness of the internal controller [Nm/rad]. Source: libfranka@0.9.2
examples/examples_common.cpp, setDefaultBehavior."""
MAX_JOINT_ACCELERATION = (15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0)
"""Acceleration limits of the Panda [rad/s^2]. Source: libfranka@0.9.2
include/franka/rate_limiting.h, kMaxJointAcceleration, without its safety margin."""
# Torque control begins below this speed [rad/s], or after this long at rest [s].
_REST_VELOCITY = 2e-4
_LONGEST_SETTLING = 0.5
_DOF = 7
_ZEROS = [0.0] * _DOF
_JOINT_GENERATORS = (
    MotionGeneratorMode.NONE,
    MotionGeneratorMode.JOINT_POSITION,
    MotionGeneratorMode.JOINT_VELOCITY,
)


class SimulatedArm(RobotArm):
    """An arm in a `World`; several arms may share one.

    The world makes a step when the first of its arms asks for a state that it has not
    reached yet, so arms that are all read once per cycle stay in lockstep.

    A motion under torque control starts from rest: while the arm still moves it is
    slowed down by the internal controller first, and torques act thereafter.

    Args:
        world: The world, with gravity compensation for this arm.
        joint_names: The arm's 7 joints in that world, from base to flange.
        damping_ratio: Damping ratio zeta of the internal controller, > 0.
        deceleration: How fast it slows down when idle, > 0 [rad/s^2], shape (7,).
    """

    def __init__(
        self,
        world: World,
        joint_names: Sequence[str],
        *,
        damping_ratio: float = 1.0,
        deceleration: Sequence[float] = MAX_JOINT_ACCELERATION,
    ) -> None:
        self.cycle_time = world.timestep
        self.state = RobotState()
        self._world = world
        self._joints = world.joints(joint_names)
        self._limits = self._joints.effort_limits
        self._damping_ratio = damping_ratio
        self._motion = DesiredMotion(
            self.state.q_d,
            self.state.dq_d,
            self.state.ddq_d,
            lower=self._joints.lower_limits,
            upper=self._joints.upper_limits,
            deceleration=list(deceleration),
            period=world.timestep,
        )
        self._stiffness = list(DEFAULT_JOINT_IMPEDANCE)
        self._damping = _ZEROS
        self._controller: ControllerMode | None = None
        self._generator = MotionGeneratorMode.NONE
        # Whether the motors follow the client's torques instead of the impedance.
        self._torques_act = False
        self._settling_time = 0.0
        self._torques = _ZEROS
        self._target: list[float] | None = None
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
        return self.state

    @override
    def refusal(
        self,
        controller_mode: ControllerMode,
        motion_generator_mode: MotionGeneratorMode,
    ) -> str:
        if self._world.diverged_because:
            return self._world.diverged_because
        if (
            controller_mode is ControllerMode.CARTESIAN_IMPEDANCE
            or motion_generator_mode not in _JOINT_GENERATORS
        ):
            return "the simulated arm has no Cartesian control"
        is_external = controller_mode is ControllerMode.EXTERNAL_CONTROLLER
        if motion_generator_mode is MotionGeneratorMode.NONE and not is_external:
            return "the internal controller needs a motion generator"
        return ""

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
        self._torques = _ZEROS
        self._target = None
        self._settling_time = 0.0
        self.state.robot_mode = RobotMode.MOVE
        self.state.control_command_success_rate = 1.0

    @override
    def stop_motion(self) -> None:
        if self.state.robot_mode is not RobotMode.MOVE:
            return
        self._end_motion(RobotMode.IDLE)

    @override
    def command_joint_torques(self, tau: list[float]) -> None:
        if self._controller is not ControllerMode.EXTERNAL_CONTROLLER:
            raise self._not_commandable("joint torques")
        self._torques = _checked(tau, "joint torques")

    @override
    def command_joint_positions(self, q: list[float]) -> None:
        if self._generator is not MotionGeneratorMode.JOINT_POSITION:
            raise self._not_commandable("joint positions")
        self._target = _checked(q, "joint positions")

    @override
    def command_joint_velocities(self, dq: list[float]) -> None:
        if self._generator is not MotionGeneratorMode.JOINT_VELOCITY:
            raise self._not_commandable("joint velocities")
        self._target = _checked(dq, "joint velocities")

    @override
    def command_cartesian_pose(
        self, pose: list[float], elbow: list[float] | None = None
    ) -> None:
        raise self._not_commandable("a Cartesian pose")

    @override
    def command_cartesian_velocity(
        self, twist: list[float], elbow: list[float] | None = None
    ) -> None:
        raise self._not_commandable("a Cartesian velocity")

    @override
    def set_joint_impedance(self, stiffness: list[float]) -> None:
        if self.state.robot_mode is RobotMode.MOVE:
            raise ArmCommandError(
                "the joint impedance cannot be changed while a motion runs",
                remedy="stop the controllers of this arm first",
            )
        if min(_checked(stiffness, "joint impedance")) <= 0.0:
            raise InvalidCommandError(
                f"a joint impedance of {stiffness} Nm/rad is not possible",
                remedy="use 7 numbers above 0",
            )
        self._stiffness = list(stiffness)
        self._engage_impedance()

    @override
    def automatic_error_recovery(self) -> None:
        if self._world.diverged_because:
            raise ArmCommandError(
                self._world.diverged_because, remedy="reset the simulation"
            )

    def before_step(self) -> None:
        """Advance the desired motion and set the motors' controls."""
        motion = self._motion
        wants_torques = self._controller is ControllerMode.EXTERNAL_CONTROLLER
        if wants_torques and not self._torques_act and motion.is_at_rest:
            self._let_torques_act_when_settled()
        if self._target is None or wants_torques is not self._torques_act:
            motion.hold()
        elif self._generator is MotionGeneratorMode.JOINT_POSITION:
            motion.follow_positions(self._target)
        else:
            motion.follow_velocities(self._target)
        if self._torques_act:
            self._apply_torques()
        else:
            self._apply_impedance()

    def after_reset(self) -> None:
        """Take over the pose that the world was set to, at rest.

        A running motion goes on; it waits for its next command.
        """
        self._torques = _ZEROS
        self._target = None
        state = self.state
        state.q[:] = self._joints.read_positions()
        state.dq[:] = _ZEROS
        self._motion.seed(state.q, _ZEROS)
        self._engage_impedance()
        self._update_state()
        if state.robot_mode is RobotMode.OTHER:
            state.robot_mode = RobotMode.IDLE

    def _end_motion(self, mode: RobotMode) -> None:
        state = self.state
        self._controller = None
        self._generator = MotionGeneratorMode.NONE
        self._target = None
        if self._torques_act:
            self._motion.seed(state.q, state.dq)
            self._engage_impedance()
        state.tau_J_d[:] = _ZEROS
        state.robot_mode = mode
        state.control_command_success_rate = 0.0

    def _engage_impedance(self) -> None:
        self._torques_act = False
        self._damping = [
            2.0 * self._damping_ratio * sqrt(k * inertia)
            for k, inertia in zip(
                self._stiffness, self._joints.read_inertia(), strict=True
            )
        ]
        self._joints.set_servo(self._stiffness, self._damping)

    def _let_torques_act_when_settled(self) -> None:
        self._settling_time += self.cycle_time
        speed = max(map(abs, self.state.dq))
        if speed < _REST_VELOCITY or self._settling_time > _LONGEST_SETTLING:
            self._joints.set_servo(_ZEROS, _ZEROS)
            self._torques_act = True

    def _apply_torques(self) -> None:
        torques = [
            max(-limit, min(limit, tau))
            for tau, limit in zip(self._torques, self._limits, strict=True)
        ]
        self.state.tau_J_d[:] = torques
        self._joints.set_controls(torques)

    def _apply_impedance(self) -> None:
        state = self.state
        is_moving = state.robot_mode is RobotMode.MOVE
        bias = self._joints.read_bias_forces()
        weight = self._joints.read_compensation()
        inertia = self._joints.read_inertia()
        controls = []
        for i, (k, d) in enumerate(zip(self._stiffness, self._damping, strict=True)):
            control = k * state.q_d[i] + d * state.dq_d[i] + bias[i] - weight[i]
            control += inertia[i] * state.ddq_d[i]
            controls.append(control)
            if is_moving:
                tau = control - k * state.q[i] - d * state.dq[i]
                limit = self._limits[i]
                state.tau_J_d[i] = max(-limit, min(limit, tau))
        self._joints.set_controls(controls)

    def _update_state(self) -> None:
        """Read the joints and derive the link-side torques.

        A torque sensor behind the gears feels the motor less what accelerates the rotor
        and rubs in the joint. The damping of the impedance acts implicitly: it takes
        the velocity at the end of the step, the motor's reading that at its beginning.
        """
        state, joints, period = self.state, self._joints, self.cycle_time
        dq = joints.read_velocities()
        forces = joints.read_motor_forces()
        weight = joints.read_compensation()
        for i, velocity in enumerate(dq):
            change = velocity - state.dq[i]
            tau = forces[i] + weight[i] - joints.damping[i] * velocity
            tau -= joints.armature[i] * change / period
            if not self._torques_act and abs(forces[i]) < self._limits[i]:
                tau -= self._damping[i] * change
            state.dtau_J[i] = (tau - state.tau_J[i]) / period
            state.tau_J[i] = tau
        state.q[:] = state.theta[:] = joints.read_positions()
        state.dq[:] = state.dtheta[:] = dq
        state.time = self._cycle_of_state * period
        if self._world.diverged_because and state.robot_mode is not RobotMode.OTHER:
            self._end_motion(RobotMode.OTHER)

    def _not_commandable(self, what: str) -> ArmCommandError:
        controller = self._controller.value if self._controller else "none"
        return ArmCommandError(
            f"cannot command {what}: the arm is in mode {self.state.robot_mode.name}, "
            f"controller {controller}, motion generator {self._generator.value}",
            remedy="start a motion with the fitting modes first",
        )


def _checked(values: list[float], what: str) -> list[float]:
    if len(values) != _DOF or not isfinite(sum(values)):
        raise InvalidCommandError(
            f"{what} must be {_DOF} finite numbers, not {values}",
            remedy="correct the controller that commands them",
        )
    return list(values)
