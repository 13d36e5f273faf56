"""What a cycle of FrankaHW costs, against the joint interfaces of the same arm alone.

Run `python benchmarks/bench_franka_cycle.py`. "Joints alone" is the same arm in the
same world with the joint interfaces and what they need to work as FrankaHW's do: the
simulation's step, joint state with torques, commands with soft limits, low-pass and
rate limiter, the desired motion and the arm's impedance. What FrankaHW has besides is
not in it: state, model and Cartesian interfaces, the arm's checks of every command and
measurement, external forces, lost packets, the log of the last commands, faults, robot
modes. The two take turns; a ratio is the median over the turns. Processor time counts,
not that on the clock, so that other programs hardly matter. Nobody asks for state or
model, except in the last two rows.
"""

import statistics
import sys
import timeit
from collections.abc import Callable
from time import process_time

from measuring import REPEATS, print_table, print_title
from typing_extensions import override

from station.core.franka import FrankaModelInterface, FrankaStateInterface
from station.core.franka.franka_robot_state import RobotMode, RobotState
from station.core.hardware.robot_hw import ControllerInfo, InterfaceResources, RobotHW
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.arm.arm_limits import PANDA_LIMITS
from station.hw.franka.arm.control_mode import ControlMode
from station.hw.franka.commands.command_filter import CommandFilter
from station.hw.franka.commands.joint_commands import JointCommands
from station.hw.franka.commands.rate_limiter import PANDA_RATE_LIMITS
from station.hw.franka.franka_hw import FrankaHW
from station.hw.franka.franka_parameters import INITIAL_POSITIONS
from station.hw.franka.hand.finger_joints import FingerJoints
from station.hw.franka.simulated.arm_motors import ArmMotors
from station.hw.franka.simulated.desired_motion import DesiredMotion
from station.hw.franka.simulated.simulated_gripper import SimulatedGripper
from station.hw.mujoco.model_builder import (
    RobotOptions,
    add_robot,
    compile_world,
    new_world,
)
from station.hw.mujoco.world import World
from station.hw.robot_description import load_robot_description
from station.hw.srdf import disabled_collisions
from station.hw.urdf_parser import parse_urdf

CYCLES = 500
TURNS = 3 * REPEATS
PERIOD = 0.001
PANDA = "example-robot-data:panda"
FINGERS = ("panda_finger_joint1", "panda_finger_joint2")
JOINTS = tuple(f"panda_joint{number}" for number in range(1, 8))
MODES = {
    "idle": ControlMode.NONE,
    "effort": ControlMode.JOINT_TORQUE,
    "position": ControlMode.JOINT_POSITION,
    "velocity": ControlMode.JOINT_VELOCITY,
}
INTERFACES = {
    "idle": (),
    "effort": ("hardware_interface::EffortJointInterface",),
    "position": ("hardware_interface::PositionJointInterface",),
    "velocity": ("hardware_interface::VelocityJointInterface",),
}
Cycle = Callable[[], None]


class JointsAlone(RobotHW):
    """The simulated arm with its joint interfaces and nothing else.

    Args:
        kind: What is commanded, a key of `MODES`.
    """

    def __init__(self, kind: str) -> None:
        super().__init__()
        description = load_robot_description(PANDA)
        urdf = parse_urdf(description)
        spec = new_world(PERIOD)
        neighbours = tuple(disabled_collisions(description.srdf_path))
        add_robot(spec, urdf, RobotOptions(disabled_collisions=neighbours))
        self._world = World(compile_world(spec))
        self._joints = self._world.joints(JOINTS)
        self._state = state = RobotState()
        self._motion = DesiredMotion(
            state.q_d,
            state.dq_d,
            state.ddq_d,
            lower=self._joints.lower_limits,
            upper=self._joints.upper_limits,
            deceleration=list(PANDA_LIMITS.acceleration),
            period=PERIOD,
        )
        self._motors = ArmMotors(self._joints, state, 1.0)
        self._commands = JointCommands(state, JOINTS)
        self._commands.add_limits(
            [urdf.joints[name] for name in JOINTS], PANDA_RATE_LIMITS
        )
        for interface in self._commands.interfaces():
            self.register_interface(interface)
        gripper = SimulatedGripper(self._world, FINGERS[0])
        self._fingers = FingerJoints(gripper, list(FINGERS), "panda")
        self._fingers.register(self._commands.interfaces())
        self._filter = CommandFilter(PANDA_LIMITS)
        self._world.reset(dict(zip(JOINTS, INITIAL_POSITIONS, strict=True)))
        self._mode = MODES[kind]
        self._begin()

    def _begin(self) -> None:
        state = self._state
        state.robot_mode = RobotMode.MOVE if self._mode else RobotMode.IDLE
        state.q[:] = self._joints.read_positions()
        self._motion.seed(state.q, [0.0] * 7)
        self._commands.begin(self._mode)
        self._filter.begin(cutoff_frequency=100.0, rate_limiting=True)
        if self._mode is ControlMode.JOINT_TORQUE:
            self._motors.engage_torques()
        else:
            self._motors.engage_joint_impedance()

    @override
    def read(self, time: float, period: float) -> None:
        state, joints = self._state, self._joints
        self._world.step()
        self._motors.read_torques(state.dq, PERIOD)
        state.q[:] = joints.read_positions()
        state.dq[:] = joints.read_velocities()
        self._fingers.read()

    @override
    def write(self, time: float, period: float) -> None:
        self._fingers.write()
        commands, state, filtered = self._commands, self._state, self._filter
        goals = commands.goals() if commands.has_positions else []
        commands.enforce_limits(period)
        if commands.has_efforts:
            self._motors.apply_torques(filtered.torques(commands.efforts, state))
            return
        if commands.has_positions:
            q = filtered.positions(commands.positions, state, goals=goals)
            self._motion.follow_positions(q)
        elif commands.has_velocities:
            dq = filtered.velocities(commands.velocities, state)
            self._motion.follow_velocities(dq)
        else:
            self._motion.hold()
        self._motors.apply_impedance(state.q, state.dq)


def whole(kind: str) -> FrankaHW:
    """Return FrankaHW whose controllers command that kind."""
    tree = ParameterTree({"robot": {"arm_id": "panda", "robot_description": PANDA}})
    hw = FrankaHW()
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    claims = tuple(InterfaceResources(name, JOINTS) for name in INTERFACES[kind])
    if claims:
        hw.do_switch([ControllerInfo(kind, "bench/Controller", claims)], [])
    return hw


def cycle_of(hw: RobotHW) -> Cycle:
    """Return a cycle of a robot whose controllers do nothing."""

    def cycle() -> None:
        hw.read(0.0, PERIOD)
        hw.write(0.0, PERIOD)

    return cycle


def reading_cycle_of(hw: FrankaHW, *, model: bool) -> Cycle:
    """Return a cycle with a controller that reads the state, or the model too."""
    states, models = hw.get(FrankaStateInterface), hw.get(FrankaModelInterface)
    state = states.get_handle("panda_robot")
    handle = models.get_handle("panda_model")

    def cycle() -> None:
        hw.read(0.0, PERIOD)
        state.get_robot_state()
        if model:
            handle.get_mass()
            handle.get_coriolis()
            handle.get_gravity()
        hw.write(0.0, PERIOD)

    return cycle


def compare(alone: Cycle, franka: Cycle) -> tuple[float, float, float]:
    """Return the medians of both cycles [us] and of their ratio, taken in turns."""
    turns = []
    for _ in range(TURNS):
        pair = [
            timeit.timeit(one, timer=process_time, number=CYCLES)
            for one in (alone, franka)
        ]
        turns.append([seconds / CYCLES * 1e6 for seconds in pair])
    ratios = [slow / fast for fast, slow in turns]
    first, second = zip(*turns, strict=True)
    return (
        statistics.median(first),
        statistics.median(second),
        statistics.median(ratios),
    )


def main() -> int:
    """Print the table."""
    print_title("A cycle of FrankaHW, against its joint interfaces alone")
    rows: list[list[object]] = []
    for kind in MODES:
        alone = cycle_of(JointsAlone(kind))
        rows.append([kind, *compare(alone, cycle_of(whole(kind)))])
    alone = cycle_of(JointsAlone("effort"))
    for label, model in (("effort, state read", False), ("… and the model", True)):
        reading = reading_cycle_of(whole("effort"), model=model)
        rows.append([label, *compare(alone, reading)])
    print_table(["commands", "joints alone [us]", "FrankaHW [us]", "ratio"], rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
