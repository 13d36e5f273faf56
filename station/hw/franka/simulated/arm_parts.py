"""The parts of a simulated arm, which share its state and its joints."""

from collections.abc import Sequence

from station.core.franka.franka_robot_state import RobotState
from station.core.franka.joint_memory import JointMemory
from station.hw.franka.arm.arm_limits import ArmLimits, SupervisorLimits
from station.hw.franka.arm.franka_kinematics import CHAIN, compose
from station.hw.franka.arm.rigid_body import RigidBody, combine_bodies
from station.hw.franka.simulated.arm_motors import ArmMotors
from station.hw.franka.simulated.arm_step import ArmStep, CycleLog
from station.hw.franka.simulated.arm_supervisor import ArmSupervisor
from station.hw.franka.simulated.cartesian_step import (
    CartesianStep,
    EndEffectorState,
)
from station.hw.franka.simulated.contact_estimate import (
    ContactEstimate,
    MomentumObserver,
)
from station.hw.franka.simulated.desired_motion import DesiredMotion
from station.hw.franka.simulated.franka_dynamics import ArmLoad
from station.hw.franka.simulated.joint_motors import JointMotors
from station.hw.franka.simulated.joint_watch import JointWatch
from station.hw.franka.simulated.motion_check import MotionCheck
from station.hw.franka.simulated.realism import Realism
from station.hw.franka.simulated.sensor_faults import SensorFaults
from station.hw.mujoco.world import World


class ArmFrames:
    """Computes the derived fields of a state. Control thread only.

    Args:
        state: The arm's state.

    Attributes:
        is_cartesian: Whether a Cartesian motion runs. If so, commanded pose, twist and
            elbow are the client's; otherwise they follow the joint motion.
    """

    def __init__(self, state: RobotState) -> None:
        self._state = state
        self._end_effector = EndEffectorState(state.doubles, CHAIN)
        self._refreshed_at = -1.0
        self.is_cartesian = False

    def set_end_effector(
        self, end_effector: RigidBody, nominal_frame: Sequence[float]
    ) -> None:
        """Set the end effector that is mounted at the flange.

        Args:
            end_effector: Mass, centre of mass and inertia of the end effector.
            nominal_frame: Nominal end effector in the flange frame, 16 numbers.
        """
        state = self._state
        state.m_ee = end_effector.mass
        state.F_x_Cee = end_effector.center_of_mass
        state.I_ee = end_effector.inertia
        state.F_T_NE = nominal_frame
        self.set_frame(state.NE_T_EE)
        self.set_load(RigidBody())

    def set_frame(self, frame: Sequence[float]) -> None:
        """Set the end effector in the nominal end effector frame, 16 numbers."""
        state = self._state
        state.NE_T_EE = frame
        state.F_T_EE = compose(state.F_T_NE, state.NE_T_EE)
        self._refreshed_at = -1.0

    def set_stiffness_frame(self, frame: Sequence[float]) -> None:
        """Set the stiffness frame in the end effector frame, 16 numbers."""
        self._state.EE_T_K = frame

    def set_load(self, load: RigidBody) -> None:
        """Set the load that the end effector holds."""
        state = self._state
        state.m_load = load.mass
        state.F_x_Cload = load.center_of_mass
        state.I_load = load.inertia
        total = combine_bodies(
            RigidBody(state.m_ee, tuple(state.F_x_Cee), tuple(state.I_ee)), load
        )
        state.m_total = total.mass
        state.F_x_Ctotal = total.center_of_mass
        state.I_total = total.inertia

    def invalidate(self) -> None:
        """Make the next `refresh` compute, even if no time has passed."""
        self._refreshed_at = -1.0

    def refresh(self) -> bool:
        """Update the derived fields; return False if they were up to date."""
        state = self._state
        # Poses are computed on the first request in a cycle: few cycles have a reader.
        if self._refreshed_at == state.time:
            return False
        self._refreshed_at = state.time
        self._end_effector.refresh()
        # In a Cartesian motion `CartesianStep` writes the commanded fields.
        if not self.is_cartesian:
            self._end_effector.command_desired()
        return True


_FIELDS = (
    "q", "dq", "dtheta", "tau_J", "dtau_J", "q_d", "dq_d", "ddq_d", "tau_J_d"
)  # fmt: skip


def new_joint_memory(state: RobotState, *, is_rigid: bool = True) -> JointMemory:
    """Return the memory of the joints of a state.

    Args:
        state: The arm's state.
        is_rigid: Whether `theta` of the state is the position of the links.
    """
    return JointMemory(
        7,
        positions=state.doubles("theta") if is_rigid else None,
        **{name: state.doubles(name) for name in _FIELDS},
    )


class ArmParts:
    """The parts of one arm in a world. Control thread only.

    Args:
        world: The world, with gravity compensation for this arm.
        joint_names: The arm's 7 joints in that world, from base to flange.
        limits: Limits of this kind of arm.
        thresholds: Thresholds that Franka does not publish.
        hand: Name of the body that a simulated collision hits.
        gravity: Acceleration of gravity in the base frame [m/s^2], shape (3,).
        realism: Disturbances of the arm; None for an ideal arm.

    Attributes:
        joint_names: As given.
        limits: As given.
        state: The state of the arm, which all parts share.
        memory: State and commands of the joints, over the memory of the state.
        motion: The desired motion.
        motors: The internal controllers.
        load: The configured load.
        frames: Frames and derived state.
        faults: The faults of the arm.
        step: Actions of the arm before and after a step of the world.
        supervisor: Finds and keeps the errors.
        contact: External torques and the thresholds for them.
    """

    def __init__(
        self,
        world: World,
        joint_names: Sequence[str],
        *,
        limits: ArmLimits,
        thresholds: SupervisorLimits,
        hand: str,
        gravity: Sequence[float],
        realism: Realism | None,
    ) -> None:
        joints, period = world.joints(joint_names), world.timestep
        simulator = joints.simulator_memory()
        self.joint_names, self.limits = tuple(joint_names), limits
        self.state = state = RobotState()
        state.O_ddP_O = gravity
        self.memory = memory = new_joint_memory(state, is_rigid=realism is None)
        self.motion = DesiredMotion(
            memory,
            lower=limits.lower,
            upper=limits.upper,
            deceleration=limits.acceleration,
            period=period,
        )
        self.check = check = MotionCheck(memory, limits, period)
        joint_motors = JointMotors(memory, simulator, period)
        self.motors = ArmMotors(joints, state, memory, joint_motors)
        self.load = ArmLoad(gravity)
        self.frames = ArmFrames(state)
        self.faults = SensorFaults(world, joints, hand)
        tool = state.doubles("F_T_EE")
        has_hand = hand.endswith("_hand")
        watch = JointWatch(
            memory, CHAIN, tool, limits, thresholds, period, has_hand=has_hand
        )
        log = CycleLog(state.motion(), 7)
        self.step = ArmStep(
            memory,
            state,
            motion=self.motion,
            cartesian=CartesianStep(memory, check, state.doubles, CHAIN, period),
            motors=joint_motors,
            actuators=self.motors,
            load=self.load,
            faults=self.faults,
            check=check,
            watch=watch,
            log=log,
            world=world.stepping,
        )
        self.supervisor = ArmSupervisor(state, thresholds, watch, log)
        seen = (joints, state, limits, self.step)
        self.contact = (
            ContactEstimate(*seen)
            if realism is None
            else MomentumObserver(*seen, realism, memory, simulator)
        )
        self.step.observer = self.contact.observer
        if realism is not None:
            joint_motors.is_late = realism.commands_are_late
