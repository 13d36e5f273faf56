"""The matrix of controllers that may share an arm, and the modes that result."""

from itertools import combinations_with_replacement

import pytest

from station.core.hardware.robot_hw import ControllerInfo, InterfaceResources
from station.hw.franka.arm.control_mode import (
    ControlMode,
    arm_id_of,
    control_mode_of,
    find_conflicts,
    is_supported,
)

EFFORT = "hardware_interface::EffortJointInterface"
POSITION = "hardware_interface::PositionJointInterface"
VELOCITY = "hardware_interface::VelocityJointInterface"
POSE = "franka_hw::FrankaPoseCartesianInterface"
TWIST = "franka_hw::FrankaVelocityCartesianInterface"
STATE = "hardware_interface::JointStateInterface"
JOINTS = tuple(f"panda_joint{number}" for number in range(1, 8))
ROBOT = ("panda_robot",)

KINDS = {
    "jt": (EFFORT, JOINTS),
    "jp": (POSITION, JOINTS),
    "jv": (VELOCITY, JOINTS),
    "cp": (POSE, ROBOT),
    "cv": (TWIST, ROBOT),
}
COMPATIBLE = {("jt", "jp"), ("jt", "jv"), ("jt", "cp"), ("jt", "cv")}


def controller(name: str, *claims: tuple[str, tuple[str, ...]]) -> ControllerInfo:
    resources = tuple(InterfaceResources(i, r) for i, r in claims)
    return ControllerInfo(name, "test/Controller", resources)


@pytest.mark.parametrize("kind", KINDS)
def test_single_controller_is_accepted(kind: str) -> None:
    assert find_conflicts([controller("a", KINDS[kind])], "panda") == []


@pytest.mark.parametrize("pair", list(combinations_with_replacement(KINDS, 2)))
def test_only_torque_and_one_motion_go_together(pair: tuple[str, str]) -> None:
    first, second = pair
    running = [controller("a", KINDS[first]), controller("b", KINDS[second])]
    assert (find_conflicts(running, "panda") == []) is (pair in COMPATIBLE)


@pytest.mark.parametrize("kind", ["jp", "jv", "cp", "cv"])
def test_torque_and_motion_may_come_from_one_controller(kind: str) -> None:
    both = controller("a", KINDS["jt"], KINDS[kind])
    assert find_conflicts([both], "panda") == []


@pytest.mark.parametrize("kinds", [("jp",) * 3, ("jt", "jp", "jp"), ("jt", "jt", "cv")])
def test_three_claims_of_one_resource_are_refused(kinds: tuple[str, ...]) -> None:
    running = [controller(f"c{i}", KINDS[kind]) for i, kind in enumerate(kinds)]
    assert find_conflicts(running, "panda")


def test_cartesian_control_of_two_arms_is_no_conflict() -> None:
    running = [controller("a", KINDS["cp"]), controller("b", (POSE, ("panda2_robot",)))]
    assert find_conflicts(running, "panda") == []


def test_reading_controllers_never_conflict() -> None:
    readers = [controller(name, (STATE, ())) for name in "ab"]
    assert find_conflicts([*readers, controller("c", KINDS["jt"])], "panda") == []


@pytest.mark.parametrize(
    ("claim", "reason"),
    [
        ((POSITION, ("joint1",)), "'joint1' of 'a' names no arm"),
        (("my::Interface", JOINTS), "'a' claims 'panda_joint1' through my::Interface"),
        ((EFFORT, JOINTS[:6]), "all 7 joints or for none, but 6 are claimed"),
        ((VELOCITY, JOINTS[:1]), "joint_velocity commands for all 7"),
    ],
)
def test_conflict_says_why(claim: tuple[str, tuple[str, ...]], reason: str) -> None:
    conflicts = find_conflicts([controller("a", claim)], "panda")
    assert reason in conflicts[0].reason


def test_conflict_names_resource_and_holders() -> None:
    running = [controller("a", KINDS["jp"]), controller("b", KINDS["jp"])]
    conflict = find_conflicts(running, "panda")[0]
    assert conflict.resource == "panda_joint1"
    assert conflict.holders == (("a", POSITION), ("b", POSITION))


def test_partial_claim_on_another_arm_is_that_arms_business() -> None:
    other = controller("a", (EFFORT, ("left_joint1",)))
    assert find_conflicts([other], "panda") == []


def test_ten_of_all_combinations_are_supported() -> None:
    supported = [
        int(mode) for mode in map(ControlMode, range(32)) if is_supported(mode)
    ]
    assert supported == [0, 1, 2, 3, 4, 5, 8, 9, 16, 17]


def test_modes_of_controllers_add_up() -> None:
    running = [controller("a", KINDS["jt"]), controller("b", KINDS["cv"])]
    assert control_mode_of(running, "panda") == (
        ControlMode.JOINT_TORQUE | ControlMode.CARTESIAN_VELOCITY
    )
    assert control_mode_of(running, "left") is ControlMode.NONE
    assert control_mode_of([controller("a", (EFFORT, JOINTS[:6]))], "panda") == 0


def test_mode_is_described_in_words() -> None:
    assert ControlMode.NONE.describe() == "<none>"
    assert ControlMode(19).describe() == "joint_torque, joint_position, cartesian_pose"


@pytest.mark.parametrize(
    ("resource", "arm_id"),
    [
        ("panda_joint1", "panda"),
        ("my_robot_joint7", "my_robot"),
        ("a_joint_joint3", "a_joint"),
        ("left_robot", "left"),
        ("_joint1", None),
        ("_robot", None),
        ("joint1", None),
    ],
)
def test_arm_is_found_in_a_resource_name(resource: str, arm_id: str | None) -> None:
    assert arm_id_of(resource) == arm_id
