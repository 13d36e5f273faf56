"""Each error of the arm that a simulation can have, by its cause, through FrankaHW."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from math import cos, pi
from pathlib import Path

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.franka import FaultKind
from station.core.franka.franka_errors import ERROR_INDEX, ERROR_NAMES, error_names
from station.core.franka.franka_services import SimulatedFault
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.franka_hw import FrankaHW
from station.hw.franka.franka_parameters import INITIAL_POSITIONS
from station.memory.doubles import put
from tests.hw.franka.command_bench import Bench
from tests.hw.franka.test_franka_hw import PERIOD

PREFIX = "joint_motion_generator_"
CARTESIAN = "cartesian_motion_generator_"
AFTER_IK = "cartesian_motion_generator_joint_"
# Desk only, or without a meaning in a simulation.
NOT_SIMULATED = {5, 8, 10, 23, 24, 33, 35, 36, 37, 38, 39, 40}
ZEROS = [0.0] * 7
BESIDE_AXIS = (0.0, -0.1, 0.0, -0.4, 0.0, 3.3, pi / 4)
HIGH = {
    f"{bound}_{what}_thresholds_{kind}": [1e3] * size
    for bound in ("lower", "upper")
    for what, size in (("torque", 7), ("force", 6))
    for kind in ("acceleration", "nominal")
}

Drive = Callable[["Bench"], Iterator[None]]


@dataclass(frozen=True)
class Cause:
    """What raises an error.

    Attributes:
        name: The error.
        where: Its place.
        drive: Commands what leads there; one cycle per step.
        positions: Where the arm starts [rad].
        robot: More parameters of the robot.
        also: Errors that the same cause cannot but raise, too.
    """

    name: str
    where: str
    drive: Drive
    positions: tuple[float, ...] = INITIAL_POSITIONS
    robot: dict[str, object] = field(default_factory=dict)
    also: tuple[str, ...] = ()


def torques(joint: int, largest: float, *, stuck: bool = False) -> Drive:
    """Drive one joint with a torque that grows by 0.5 Nm per cycle."""

    def drive(bench: Bench) -> Iterator[None]:
        if stuck:
            fault = SimulatedFault(FaultKind.STUCK_JOINT, 10_000, joint)
            bench.services.simulation().inject(fault)
        bench.start("jt")
        for cycle in range(5_000):
            bench.hw.commands.efforts[joint - 1] = min(largest, 0.5 * cycle)
            yield

    return drive


def torque_step(bench: Bench) -> Iterator[None]:
    bench.start("jt")
    for cycle in range(200):
        bench.hw.commands.efforts[3] = 2.0 if cycle > 150 else 0.0
        yield


def velocities(wanted: dict[int, float], acceleration: float = 5.0) -> Drive:
    """Drive joints with velocities [rad/s] that grow slowly."""

    def drive(bench: Bench) -> Iterator[None]:
        bench.start("jv")
        ramp = 0.0
        for _ in range(5_000):
            ramp = min(
                1.0, ramp + acceleration * PERIOD / max(map(abs, wanted.values()))
            )
            for joint, velocity in wanted.items():
                bench.hw.commands.velocities[joint - 1] = ramp * velocity
            yield

    return drive


def position_jump(jump: float, *, after: int = 5) -> Drive:
    """Jump with joint 1, some cycles after the start."""

    def drive(bench: Bench) -> Iterator[None]:
        bench.start("jp")
        rest = list(bench.state.q_d)
        for cycle in range(after + 5):
            moved = jump if cycle >= after else 0.0
            put(bench.hw.commands.positions, [rest[0] + moved, *rest[1:]])
            yield

    return drive


def pose_jump(jump: float, *, after: int = 5) -> Drive:
    """Jump along x with the end effector, some cycles after the start."""

    def drive(bench: Bench) -> Iterator[None]:
        bench.start("cp")
        rest = bench.pose()
        for cycle in range(after + 5):
            moved = list(rest)
            moved[12] += jump if cycle >= after else 0.0
            bench.command_pose(moved)
            yield

    return drive


def no_pose(bench: Bench) -> Iterator[None]:
    bench.start("cp")
    for _ in range(3):
        bench.command_pose([1.0] * 16)
        yield


def elbow(angle: float, sign: float) -> Drive:
    """Rest, with an elbow."""

    def drive(bench: Bench) -> Iterator[None]:
        bench.start("cv")
        for _ in range(3):
            bench.command_twist([0.0] * 6, [angle, sign])
            yield

    return drive


def along(axis: int, rates: Callable[[int], float]) -> Drive:
    """Drive the end effector along an axis with a velocity [m/s] of the cycle."""

    def drive(bench: Bench) -> Iterator[None]:
        bench.start("cv")
        for cycle in range(4_000):
            twist = [0.0] * 6
            twist[axis] = rates(cycle)
            bench.command_twist(twist)
            yield

    return drive


def pushed(link: str, force: list[float]) -> Drive:
    """Hold while somebody pushes a link."""

    def drive(bench: Bench) -> Iterator[None]:
        bench.services.set_joint_impedance([150.0] * 7)
        bench.start("jp")
        bench.services.simulation().apply_force(link, force, [0.0] * 3, 5.0)
        for _ in range(2_000):
            yield

    return drive


def losing_packets(bench: Bench) -> Iterator[None]:
    bench.start("jp")
    for cycle in range(50):
        if cycle == 10:
            bench.services.simulation().inject(
                SimulatedFault(FaultKind.LOST_PACKETS, 20)
            )
        yield


FAST = {"supervisor": {"velocity_factor": 10.0}}
FOLDED = {"supervisor": {"self_collision_distance": -1.0}}
# The end effector is 9 cm beside the axis of joint 1, high above it: nearly singular.
NARROW = {"supervisor": {"self_collision_distance": -1.0, "singular_start": 0.0}}

CAUSES = [
    Cause(
        "joint_position_limits_violation",
        "joint1",
        torques(1, 20.0),
        (0.5, *INITIAL_POSITIONS[1:]),
        FAST,
    ),
    Cause(
        "cartesian_position_limits_violation",
        "y",
        velocities({1: 0.5}),
        robot={
            "supervisor": {
                "cartesian_lower": [-1.0, -0.2, 0.0],
                "cartesian_upper": [1.0, 0.2, 1.2],
            }
        },
    ),
    Cause(
        "self_collision_avoidance_violation",
        "link5 and hand",
        velocities({6: -0.5}),
        (0.0, -pi / 4, 0.0, -3 * pi / 4, 0.0, 0.8, -pi / 4),
    ),
    Cause("joint_velocity_violation", "joint7", torques(7, 1.0)),
    Cause(
        "cartesian_velocity_violation",
        "end effector",
        velocities({2: 2.1, 4: -2.1}, acceleration=3.0),
        (0.0, -1.2, 0.0, -0.3, 0.0, 2.8, pi / 4),
    ),
    Cause(
        "joint_reflex",
        "joint3",
        pushed("panda_link4", [0.0, 300.0, 0.0]),
        robot={"collision_config": {k: v for k, v in HIGH.items() if "force" in k}},
    ),
    Cause("cartesian_reflex", "y", pushed("panda_hand", [0.0, 30.0, 0.0])),
    Cause(
        "max_path_pose_deviation_violation",
        "translation",
        pushed("panda_hand", [0.0, 40.0, 0.0]),
        robot={
            "supervisor": {"path_deviation": [0.05, 1.0, 1.0]},
            "collision_config": HIGH,
        },
    ),
    Cause(
        "joint_position_motion_generator_start_pose_invalid",
        "joint1",
        position_jump(0.02, after=0),
    ),
    Cause(
        f"{PREFIX}position_limits_violation",
        "joint1",
        position_jump(4e-6),
        (2.8973 - 1e-7, *INITIAL_POSITIONS[1:]),
    ),
    Cause(
        f"{PREFIX}velocity_limits_violation",
        "joint1",
        velocities({1: 2.3}),
    ),
    Cause(
        f"{PREFIX}velocity_discontinuity",
        "joint1",
        position_jump(1e-4),
        also=(f"{PREFIX}acceleration_discontinuity",),
    ),
    Cause(f"{PREFIX}acceleration_discontinuity", "joint1", position_jump(1e-5)),
    Cause(
        "cartesian_position_motion_generator_start_pose_invalid",
        "translation",
        pose_jump(0.02, after=0),
    ),
    Cause(f"{CARTESIAN}elbow_limit_violation", "elbow", elbow(0.005, -1.0)),
    Cause(
        f"{CARTESIAN}velocity_limits_violation",
        "rotation",
        along(5, lambda cycle: 5e-3 * cycle),
    ),
    Cause(
        f"{CARTESIAN}velocity_discontinuity",
        "translation",
        pose_jump(1e-4),
        also=(f"{CARTESIAN}acceleration_discontinuity",),
    ),
    Cause(f"{CARTESIAN}acceleration_discontinuity", "translation", pose_jump(1e-5)),
    Cause(f"{CARTESIAN}elbow_sign_inconsistent", "elbow", elbow(0.0, 1.0)),
    Cause(f"{CARTESIAN}start_elbow_invalid", "elbow", elbow(0.1, -1.0)),
    Cause("communication_constraints_violation", "", losing_packets),
    Cause(
        "power_limit_violation",
        "",
        torques(1, 20.0),
        robot={"supervisor": {"power": 20.0}},
    ),
    Cause(
        f"{AFTER_IK}position_limits_violation",
        "joint4",
        along(0, lambda cycle: -min(0.1, 1e-5 * cycle)),
        (0.0, -pi / 4, 0.0, -3.0, 0.0, pi / 2, pi / 4),
        FOLDED,
    ),
    Cause(
        f"{AFTER_IK}velocity_limits_violation",
        "joint2",
        along(0, lambda cycle: 0.6 - 0.6 * cos(pi * min(cycle, 800) / 800)),
    ),
    Cause(
        f"{AFTER_IK}velocity_discontinuity",
        "joint7",
        along(1, lambda cycle: 2.5e-5 * cycle * cycle),
        BESIDE_AXIS,
        NARROW,
    ),
    Cause(
        f"{AFTER_IK}acceleration_discontinuity",
        "joint1",
        along(1, lambda cycle: 1e-3 * cycle),
        BESIDE_AXIS,
        NARROW,
        also=(f"{AFTER_IK}velocity_discontinuity",),
    ),
    Cause("cartesian_position_motion_generator_invalid_frame", "O_T_EE", no_pose),
    Cause("controller_torque_discontinuity", "joint4", torque_step),
    Cause("tau_j_range_violation", "joint4", torques(4, 87.0, stuck=True)),
]


@pytest.fixture(scope="module")
def unlimited(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Return a Panda without soft limits, so that commands reach the arm unclamped."""
    panda = load_robot_files("example-robot-data:panda")
    directory: Path = tmp_path_factory.mktemp("panda")
    for path, text in (
        ("urdf/panda.urdf", re.sub(r"<safety_controller[^>]*/>", "", panda.xml)),
        ("srdf/panda.srdf", (panda.srdf_path or Path()).read_text(encoding="utf-8")),
    ):
        (directory / path).parent.mkdir()
        (directory / path).write_text(text, encoding="utf-8")
    return str(directory / "urdf" / "panda.urdf")


def test_every_error_that_can_be_simulated_has_a_cause_here() -> None:
    simulated = {name for i, name in enumerate(ERROR_NAMES) if i not in NOT_SIMULATED}
    assert {cause.name for cause in CAUSES} == simulated


@pytest.mark.parametrize("cause", CAUSES, ids=lambda cause: cause.name)
def test_error_is_raised_by_its_cause_and_no_other(
    cause: Cause, unlimited: str
) -> None:
    parameters = {
        "arm_id": "panda",
        "robot_description": unlimited,
        "realism": "ideal",
        "rate_limiting": False,
        "cutoff_frequency": 1000.0,
        "initial_positions": list(cause.positions),
        **cause.robot,
    }
    tree = ParameterTree({"robot": parameters})
    hw = FrankaHW()
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    for _ in range(5):
        hw.read(0.0, PERIOD)
    assert hw.mode() == "idle", hw.arm.errors()
    bench = Bench(hw)
    for _ in cause.drive(bench):
        hw.write(0.0, PERIOD)
        hw.read(0.0, PERIOD)
        if hw.mode() != "move":
            break

    assert hw.mode() == "reflex"
    raised = {error.name: error for error in reversed(hw.arm.errors())}
    assert {*raised} == {cause.name, *cause.also}
    error = raised[cause.name]
    assert error.where == cause.where
    assert error.value != error.limit or error.name.endswith("invalid_frame")
    assert error.cycle == round(hw.robot_state.time / PERIOD)
    assert hw.robot_state.current_errors[ERROR_INDEX[cause.name]]
    assert hw.robot_state.last_motion_errors == hw.robot_state.current_errors
    assert cause.name in hw.interruption_of(bench.controller)

    hw.do_switch([], [bench.controller])  # as the manager does
    bench.services.simulation().clear_faults()
    for _ in range(300):
        hw.read(0.0, PERIOD)
    assert bench.services.error_recovery()
    for _ in range(500):
        hw.read(0.0, PERIOD)
    assert hw.mode() == "idle", hw.arm.errors()
    assert error_names(hw.robot_state.last_motion_errors)
    bench.start("jp")
    for _ in range(200):
        hw.write(0.0, PERIOD)
        hw.read(0.0, PERIOD)
    assert hw.mode() == "move", hw.arm.errors()
