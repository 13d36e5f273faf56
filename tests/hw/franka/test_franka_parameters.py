"""Parameters of FrankaHW: defaults, and refusals with key and value."""

import pytest

from station.core.errors import ParameterError
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.arm.arm_limits import LIMITS_OF_ARM
from station.hw.franka.arm.collision_behavior import DEFAULT_COLLISION_BEHAVIOR
from station.hw.franka.arm.service_limits import ServiceLimits
from station.hw.franka.franka_parameters import (
    INITIAL_POSITIONS,
    read_command_settings,
    read_parameters,
)

NEEDED = {"arm_id": "panda", "robot_description": "example-robot-data:panda"}


def params(**values: object) -> Parameters:
    return Parameters(ParameterTree({"robot": {**NEEDED, **values}}), "robot")


def test_default_parameters_equal_the_files_of_franka_ros() -> None:
    read, settings = read_parameters(params()), read_command_settings(params())
    assert read.joint_names == tuple(f"panda_joint{n}" for n in range(1, 8))
    assert read.joint_limit_warning_threshold == 0.1
    assert read.initial_positions == INITIAL_POSITIONS
    assert settings.rate_limiting
    assert settings.cutoff_frequency == 100.0
    assert settings.internal_controller is None


def test_a_simulated_arm_errs_unless_it_is_ideal() -> None:
    assert read_parameters(params()).is_realistic
    assert not read_parameters(params(realism="ideal")).is_realistic
    assert read_parameters(params(realism_seed=3)).realism_seed == 3
    for wrong in ({"realism": "real"}, {"realism_seed": -1}):
        with pytest.raises(ParameterError, match="realism"):
            read_parameters(params(**wrong))


def test_identified_friction_is_read_by_joint_and_refused_by_name() -> None:
    friction = {"coulomb": 0.3, "viscous": 0.1}
    read = read_parameters(params(identified={"panda_joint7": friction}))
    assert read.identified == {"panda_joint7": (0.3, 0.1)}
    for wrong in (
        3,
        {"joint7": friction},
        {"panda_joint7": {"coulomb": 0.3}},
        {"panda_joint7": {**friction, "static": 1.0}},
        {"panda_joint7": {**friction, "viscous": -0.1}},
    ):
        with pytest.raises(ParameterError, match="identified"):
            read_parameters(params(identified=wrong))
    with pytest.raises(ParameterError, match="realism: typical"):
        read_parameters(params(realism="ideal", identified={"panda_joint7": friction}))


def test_robot_ip_names_a_real_arm() -> None:
    assert read_parameters(params(robot_ip="172.16.0.2")).robot_ip == "172.16.0.2"
    assert read_parameters(params()).robot_ip is None
    with pytest.raises(ParameterError, match="robot_ip"):
        read_parameters(params(robot_ip=" "))


@pytest.mark.parametrize(
    ("told", "arm"),
    [
        ({}, "panda"),
        ({"arm_id": "left"}, "panda"),
        ({"arm_id": "fr3"}, "fr3"),
        ({"arm_id": "fr3_left"}, "fr3"),
        ({"arm": "fr3"}, "fr3"),
        ({"arm": "panda", "arm_id": "fr3"}, "panda"),
        ({"arm_type": "fr3"}, "fr3"),
        ({"arm_type": "panda", "arm_id": "fr3"}, "panda"),
        ({"arm": "fr3", "arm_type": "fr3"}, "fr3"),
    ],
)
def test_arm_is_chosen_by_name_and_else_by_its_prefix(told: dict, arm: str) -> None:
    read = read_parameters(params(**told))
    assert (read.arm, read.limits) == (arm, LIMITS_OF_ARM[arm])


def test_arm_with_the_name_of_another_kind_is_remarked() -> None:
    told = read_parameters(params(arm="fr3")).remark
    assert "arm_id: fr3" in told
    assert "arm: panda" in told
    for fits in ({}, {"arm_id": "fr3"}, {"arm": "fr3", "arm_id": "left"}):
        assert read_parameters(params(**fits)).remark is None


def test_older_name_of_the_arm_may_not_contradict_the_newer() -> None:
    with pytest.raises(ParameterError, match=r"robot/arm'.*arm_type left out"):
        read_parameters(params(arm="panda", arm_type="fr3"))


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("arm", "iiwa"),
        ("arm_type", "iiwa"),
        ("arm_id", "my arm"),
        ("arm_id", 7),
        ("joint_names", ["panda_joint1"]),
        ("joint_names", ["panda_joint1"] * 7),
        ("joint_names", [f"j{n}" for n in range(7)]),
        ("joint_limit_warning_threshold", -0.1),
        ("joint_limit_warning_threshold", "wide"),
        ("initial_positions", [0.0] * 6),
        ("base_xyz", [0.0, float("nan"), 0.0]),
        ("base_rpy", [0.0, 0.0, 90.0]),
        ("robot_description", None),
    ],
)
def test_impossible_value_is_refused_with_its_key(key: str, value: object) -> None:
    with pytest.raises(ParameterError, match=f"robot/{key}'"):
        read_parameters(params(**{key: value}))


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("rate_limiting", "yes"),
        ("cutoff_frequency", 0.0),
        ("cutoff_frequency", float("inf")),
        ("internal_controller", "none"),
    ],
)
def test_impossible_setting_is_refused_with_its_key(key: str, value: object) -> None:
    with pytest.raises(ParameterError, match=f"robot/{key}'"):
        read_command_settings(params(**{key: value}))


def test_unknown_parameter_is_refused_with_the_known_ones() -> None:
    with pytest.raises(ParameterError, match="robot/armid'") as caught:
        read_parameters(params(armid="panda"))
    assert "arm_id" in caught.value.remedy


def test_franka_controls_own_file_is_read() -> None:
    torques, forces = (
        [20.0, 20.0, 18.0, 18.0, 16.0, 14.0, 12.0],
        [20.0] * 3 + [25.0] * 3,
    )
    values = {
        "arm_id": "panda",
        "robot_description": "example-robot-data:panda",
        "joint_names": [f"panda_joint{number}" for number in range(1, 8)],
        "joint_limit_warning_threshold": 0.1,
        "rate_limiting": True,
        "cutoff_frequency": 100,
        "internal_controller": "joint_impedance",
        "realtime_config": "enforce",
        "collision_config": {
            f"{bound}_{what}_thresholds_{phase}": list(numbers)
            for bound in ("lower", "upper")
            for what, numbers in (("torque", torques), ("force", forces))
            for phase in ("acceleration", "nominal")
        },
    }
    read = read_parameters(Parameters(ParameterTree({"robot": values}), "robot"))
    assert read.collision_behavior == DEFAULT_COLLISION_BEHAVIOR


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("upper_torque_thresholds_nominal", [1.0] * 7),
        ("lower_force_thresholds_nominal", [0.0] * 6),
    ],
)
def test_impossible_thresholds_are_refused(key: str, value: list[float]) -> None:
    values = {
        "arm_id": "panda",
        "robot_description": "x",
        "collision_config": {key: value},
    }
    with pytest.raises(ParameterError, match="collision_config"):
        read_parameters(Parameters(ParameterTree({"robot": values}), "robot"))


def test_largest_load_is_the_payload_unless_configured():
    assert read_parameters(params()).service_limits == ServiceLimits(load_mass=3.0)
    read = read_parameters(params(service_limits={"load_mass": 5.0}))
    assert read.service_limits == ServiceLimits(load_mass=5.0)


@pytest.mark.parametrize(
    "limits", [{"load_mass": 0.0}, {"push_force": -1.0}, {"lode_mass": 1.0}]
)
def test_impossible_service_limit_is_refused(limits):
    with pytest.raises(ParameterError, match="service_limits/"):
        read_parameters(params(service_limits=limits))
