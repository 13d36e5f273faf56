"""The parts of a simulated arm, which share its state and its joints."""

from collections.abc import Sequence

from station.core.franka.franka_robot_state import RobotState
from station.hw.franka.arm.arm_limits import ArmLimits
from station.hw.franka.arm.supervisor_limits import SupervisorLimits
from station.hw.franka.simulated.arm_cycle import ArmCycle
from station.hw.franka.simulated.arm_frames import ArmFrames
from station.hw.franka.simulated.arm_load import ArmLoad
from station.hw.franka.simulated.arm_motors import ArmMotors
from station.hw.franka.simulated.arm_sensors import ArmSensors
from station.hw.franka.simulated.arm_supervisor import ArmSupervisor
from station.hw.franka.simulated.contact_estimate import ContactEstimate
from station.hw.franka.simulated.motion_follower import MotionFollower
from station.hw.franka.simulated.observed_contact import ObservedContact
from station.hw.franka.simulated.realism import Realism
from station.hw.franka.simulated.sensor_faults import SensorFaults
from station.hw.mujoco.world import World


class ArmParts:
    """What one arm in a world is made of. Control thread only.

    Args:
        world: The world, with gravity compensation for this arm.
        joint_names: The arm's 7 joints in that world, from base to flange.
        limits: Limits of this kind of arm.
        thresholds: Thresholds that Franka does not publish.
        hand: Body that a simulated collision hits.
        gravity: Acceleration of gravity in the base frame [m/s^2], shape (3,).
        realism: What disturbs the arm; None for an ideal arm.

    Attributes:
        joint_names: As given.
        limits: As given.
        state: The state of the arm, which all parts share.
        cycle: The arithmetic of the arm's cycle.
        follower: Follows the client's commands.
        motors: The motors and the internal controllers.
        load: The configured load.
        frames: Frames and derived state.
        supervisor: Finds and keeps the errors.
        faults: The faults of the arm.
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
        is_rigid = realism is None
        self.cycle = cycle = ArmCycle(
            state, limits, thresholds, simulator, period, is_rigid=is_rigid
        )
        positions = cycle.memory.positions
        self.follower = MotionFollower(state, cycle, limits, period)
        self.motors = ArmMotors(joints, state, cycle)
        self.load = ArmLoad(gravity)
        self.frames = ArmFrames(state)
        self.supervisor = ArmSupervisor(
            state, limits, thresholds, cycle.watch, cycle.log, positions
        )
        self.supervisor.has_hand = hand.endswith("_hand")
        self.faults = SensorFaults(world, joints, hand)
        self.sensors = ArmSensors(
            joints,
            state,
            positions=positions,
            step=cycle.step,
            load=self.load,
            faults=self.faults,
            period=period,
        )
        seen = (joints, state, limits, self.sensors.load_torques)
        self.contact = (
            ContactEstimate(*seen)
            if realism is None
            else ObservedContact(*seen, realism, cycle, simulator)
        )
        if realism is not None:
            cycle.motors.is_late = realism.commands_are_late
