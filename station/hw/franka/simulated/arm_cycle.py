"""Put together the kernel's parts of one simulated arm's cycle."""

from station.core.franka.franka_robot_state import MODE, RobotState
from station.core.franka.joint_memory import JointMemory
from station.hw.franka.arm.arm_limits import ArmLimits
from station.hw.franka.arm.franka_kinematics import CHAIN
from station.hw.franka.arm.supervisor_limits import SupervisorLimits
from station.hw.franka.simulated.arm_step import ArmStep
from station.hw.franka.simulated.cartesian_step import CartesianStep
from station.hw.franka.simulated.command_check import CommandCheck
from station.hw.franka.simulated.cycle_log import CycleLog
from station.hw.franka.simulated.desired_motion import DesiredMotion
from station.hw.franka.simulated.inverse_kinematics import InverseKinematics
from station.hw.franka.simulated.joint_motors import JointMotors
from station.hw.franka.simulated.joint_watch import JointWatch
from station.hw.mujoco.simulator_memory import SimulatorMemory
from station.memory.doubles import zeros

REACH = 1.3
"""Larger than the distance of any end effector from any joint axis [m]."""
_FIELDS = (
    "q", "dq", "dtheta", "tau_J", "dtau_J", "q_d", "dq_d", "ddq_d", "tau_J_d"
)  # fmt: skip


class ArmCycle:
    """The arithmetic of one arm's cycle, over the memory of its state.

    Args:
        state: The arm's state.
        limits: The arm's limits.
        thresholds: Thresholds that Franka does not publish.
        simulator: The simulator's memory of the arm's joints.
        period: Duration of a cycle [s], > 0.
        is_rigid: Whether `theta` of the state is the position of the links.

    Attributes:
        memory: State and commands of the joints.
        motion: The desired motion.
        cartesian: The motion of the end effector.
        motors: Controls and torque sensors.
        watch: Looks at the readings.
        log: The last cycles.
        step: The usual cycle, made of these parts.
    """

    def __init__(
        self,
        state: RobotState,
        limits: ArmLimits,
        thresholds: SupervisorLimits,
        simulator: SimulatorMemory,
        period: float,
        *,
        is_rigid: bool = True,
    ) -> None:
        self.memory = JointMemory(
            7,
            positions=state.doubles("theta") if is_rigid else None,
            **{name: state.doubles(name) for name in _FIELDS},
        )
        self.motion = DesiredMotion(
            self.memory,
            lower=limits.lower,
            upper=limits.upper,
            deceleration=limits.acceleration,
            period=period,
        )
        check = CommandCheck(
            self.memory,
            lower=limits.lower,
            upper=limits.upper,
            velocity=limits.velocity,
            acceleration=limits.acceleration,
            jerk=limits.jerk,
            torque_rate=limits.torque_rate,
            period=period,
        )
        self.cartesian = _cartesian_step(state, self.memory, check, limits, period)
        self.motors = JointMotors(self.memory, simulator, period)
        self.watch = _watch(state, self.memory, limits, thresholds, period)
        self.log = CycleLog(state.motion(), 7)
        self.step = ArmStep(
            self.memory,
            state.doubles(MODE),
            motion=self.motion,
            cartesian=self.cartesian,
            motors=self.motors,
            check=check,
            watch=self.watch,
            log=self.log,
            simulator=simulator,
        )
        self.step.has_curves = bool(limits.curves)


def _cartesian_step(
    state: RobotState,
    memory: JointMemory,
    check: CommandCheck,
    limits: ArmLimits,
    period: float,
) -> CartesianStep:
    field = state.doubles
    kinematics = InverseKinematics(
        CHAIN, field("q_d"), field("F_T_EE"), zeros(16), zeros(memory.size)
    )
    return CartesianStep(
        memory,
        kinematics,
        check,
        pose=field("O_T_EE_c"),
        twist=field("O_dP_EE_c"),
        acceleration=field("O_ddP_EE_c"),
        elbow=field("elbow_c"),
        elbow_velocity=field("delbow_c"),
        elbow_acceleration=field("ddelbow_c"),
        translation=limits.translation.bounds(),
        rotation=limits.rotation.bounds(),
        elbow_limits=limits.elbow.bounds(),
        period=period,
    )


def _watch(
    state: RobotState,
    memory: JointMemory,
    limits: ArmLimits,
    thresholds: SupervisorLimits,
    period: float,
) -> JointWatch:
    slack = thresholds.position_tolerance
    return JointWatch(
        memory,
        CHAIN,
        state.doubles("F_T_EE"),
        lower=[value - slack for value in limits.lower],
        upper=[value + slack for value in limits.upper],
        velocity=[value * thresholds.velocity_factor for value in limits.velocity],
        torque=[value * thresholds.torque_factor for value in limits.torque],
        reach=REACH,
        speed=limits.translation.velocity * thresholds.velocity_factor,
        power=thresholds.power,
        deviation=thresholds.path_deviation,
        period=period,
    )
