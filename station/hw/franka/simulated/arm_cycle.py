"""Put together the kernel's parts of one simulated arm's cycle."""

from station.core.franka.franka_robot_state import MODE, RobotState
from station.hw.franka.arm.arm_limits import ArmLimits
from station.hw.franka.arm.supervisor_limits import SupervisorLimits
from station.kernel.arm_step import ArmStep
from station.kernel.command_check import CommandCheck
from station.kernel.cycle_log import CycleLog
from station.kernel.desired_motion import DesiredMotion
from station.kernel.joint_memory import JointMemory
from station.kernel.joint_motors import JointMotors
from station.kernel.joint_watch import JointWatch
from station.kernel.simulator_memory import SimulatorMemory

REACH = 1.3
"""Larger than the distance of any end effector from any joint axis [m]."""
_FIELDS = (
    "q", "dq", "theta", "dtheta", "tau_J", "dtau_J", "q_d", "dq_d", "ddq_d", "tau_J_d"
)  # fmt: skip


class ArmCycle:
    """The arithmetic of one arm's cycle, over the memory of its state.

    Args:
        state: The arm's state.
        limits: The arm's limits.
        thresholds: Thresholds that Franka does not publish.
        simulator: The simulator's memory of the arm's joints.
        period: Duration of a cycle [s], > 0.

    Attributes:
        memory: State and commands of the joints.
        motion: The desired motion.
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
    ) -> None:
        self.memory = JointMemory(7, **{name: state.doubles(name) for name in _FIELDS})
        self.motion = DesiredMotion(
            self.memory,
            lower=limits.lower,
            upper=limits.upper,
            deceleration=limits.acceleration,
            period=period,
        )
        self.motors = JointMotors(self.memory, simulator, period)
        self.watch = _watch(self.memory, limits, thresholds, period)
        self.log = CycleLog(self.memory)
        self.step = ArmStep(
            self.memory,
            state.doubles(MODE),
            motion=self.motion,
            motors=self.motors,
            check=CommandCheck(
                self.memory,
                lower=limits.lower,
                upper=limits.upper,
                velocity=limits.velocity,
                acceleration=limits.acceleration,
                jerk=limits.jerk,
                torque_rate=limits.torque_rate,
                period=period,
            ),
            watch=self.watch,
            log=self.log,
            simulator=simulator,
        )
        self.step.has_curves = bool(limits.curves)


def _watch(
    memory: JointMemory, limits: ArmLimits, thresholds: SupervisorLimits, period: float
) -> JointWatch:
    slack = thresholds.position_tolerance
    return JointWatch(
        memory,
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
