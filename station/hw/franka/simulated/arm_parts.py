"""The parts of a simulated arm, which share its state and its joints."""

from collections.abc import Sequence

from station.core.franka.franka_robot_state import RobotState
from station.core.franka.joint_memory import JointMemory
from station.hw.franka.arm.arm_limits import ArmLimits
from station.hw.franka.arm.franka_kinematics import CHAIN
from station.hw.franka.arm.supervisor_limits import SupervisorLimits
from station.hw.franka.simulated.arm_frames import MAX_EXTENSION, ArmFrames
from station.hw.franka.simulated.arm_motors import ArmMotors
from station.hw.franka.simulated.arm_sensors import ArmSensors
from station.hw.franka.simulated.arm_step import ArmStep
from station.hw.franka.simulated.arm_supervisor import ArmSupervisor
from station.hw.franka.simulated.cartesian_step import CartesianStep
from station.hw.franka.simulated.contact_estimate import ContactEstimate
from station.hw.franka.simulated.cycle_log import CycleLog
from station.hw.franka.simulated.desired_motion import DesiredMotion
from station.hw.franka.simulated.end_effector_state import EndEffectorState
from station.hw.franka.simulated.franka_dynamics import ArmLoad
from station.hw.franka.simulated.inverse_kinematics import InverseKinematics
from station.hw.franka.simulated.joint_motors import JointMotors
from station.hw.franka.simulated.joint_watch import JointWatch
from station.hw.franka.simulated.momentum_observer import MomentumObserver
from station.hw.franka.simulated.motion_check import MotionCheck
from station.hw.franka.simulated.realism import Realism
from station.hw.franka.simulated.sensor_faults import SensorFaults
from station.hw.mujoco.world import World
from station.memory.doubles import zeros

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


def new_cartesian_step(
    state: RobotState, memory: JointMemory, check: MotionCheck, period: float
) -> CartesianStep:
    """Return a new follower of an arm's poses and twists.

    Args:
        state: The arm's state.
        memory: State and commands of its joints.
        check: Compares commanded motions with the limits.
        period: Duration of a cycle [s], > 0.
    """
    field = state.doubles
    kinematics = InverseKinematics(
        CHAIN, field("q_d"), field("F_T_EE"), zeros(16), zeros(memory.size)
    )
    end_effector = EndEffectorState(field, CHAIN, MAX_EXTENSION)
    return CartesianStep(memory, kinematics, check, end_effector, period)


class ArmParts:
    """The parts of one arm in a world. Control thread only.

    Args:
        world: The world, with gravity compensation for this arm.
        joint_names: The arm's 7 joints in that world, from base to flange.
        limits: Limits of this kind of arm.
        thresholds: Thresholds that Franka does not publish.
        hand: Body that a simulated collision hits.
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
        sensors: Reads the joints.
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
        check = MotionCheck(memory, limits, period)
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
            cartesian=new_cartesian_step(state, memory, check, period),
            motors=joint_motors,
            actuators=self.motors,
            load=self.load,
            faults=self.faults,
            check=check,
            watch=watch,
            log=log,
            simulator=simulator,
        )
        self.supervisor = ArmSupervisor(state, thresholds, watch, log)
        self.sensors = ArmSensors(
            joints,
            state,
            positions=memory.positions,
            step=self.step,
            load=self.load,
            faults=self.faults,
            period=period,
        )
        seen = (joints, state, limits, self.sensors.load_torques)
        self.contact = (
            ContactEstimate(*seen)
            if realism is None
            else MomentumObserver(*seen, realism, memory, simulator)
        )
        if realism is not None:
            joint_motors.is_late = realism.commands_are_late
