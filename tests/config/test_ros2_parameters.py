"""Parameter files of ROS 2: nodes, wildcards, namespaces, and the station's names."""

import pytest
import yaml

from station.config.loading import load_config
from station.config.ros_parameters import join_ros2, split_ros_parameters
from station.core.errors import ConfigError
from station.core.yaml_reader import parse_yaml

FILE = """
/**:
  ros__parameters:
    command_timeout: 0.5
controller_manager:
  ros__parameters:
    update_rate: 500
    arm: {type: joint_trajectory_controller/JointTrajectoryController}
    states: {type: joint_state_broadcaster/JointStateBroadcaster}
    force.type: force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster
arm:
  ros__parameters:
    joints: [j1, j2]
    command_interfaces: [effort]
    state_interfaces: [position, velocity]
    gains.j1: {p: 10.0, i: 2.0, d: 1.0, ff_velocity_scale: 0.5}
    gains.j2: {p: 10.0, i: 2.0, i_clamp_max: 1.0, i_clamp_min: -.inf, u_clamp_max: .inf}
    interpolate_from_desired_state: true
    interpolation_method: splines
    cmd_timeout: 2.0
    speed_scaling: {initial_scaling_factor: 0.5, state_interface: a/b}
    constraints: {stopped_velocity_tolerance: 0.2, j1.goal: 0.1}
    command_timeout: 0.1
force:
  ros__parameters: {sensor_name: wrist, frame_id: tool}
"""

MANAGER = "controller_manager: {{ros__parameters: {{a: {}}}}}"


def read(text):
    return split_ros_parameters(yaml.safe_load(text), "f.yaml")


def test_controllers_that_share_a_block_have_the_same_gains():
    shared = read("""
controller_manager:
  ros__parameters:
    a: {type: joint_trajectory_controller/JointTrajectoryController}
    b: {type: joint_trajectory_controller/JointTrajectoryController}
/**:
  ros__parameters:
    joints: [j]
    command_interfaces: [effort]
    gains.j: {p: 10.0, i: 2.0, ff_velocity_scale: 0.5}
""").controllers

    assert shared["a"] == shared["b"]
    assert shared["b"]["velocity_ff"] == {"j": 0.5}


def test_controllers_have_the_parameters_of_their_nodes():
    found = read(FILE)

    assert found.controllers["arm"] == {
        "type": "effort_controllers/JointTrajectoryController",
        "joints": ["j1", "j2"],
        "gains": {
            # Neither a missing bound nor a missing time is 0 in ROS 2.
            "j1": {"p": 10.0, "i": 2.0, "d": 1.0, "i_clamp": 1e6},
            "j2": {"p": 10.0, "i": 2.0, "i_clamp_max": 1.0, "i_clamp": 1e6},
        },
        "velocity_ff": {"j1": 0.5},
        "speed_scaling": 0.5,
        "allow_nonzero_velocity_at_trajectory_end": False,
        "constraints": {
            "stopped_velocity_tolerance": 0.2,
            "j1": {"goal": 0.1},
            "goal_time": 86_400.0,
        },
        "command_timeout": 0.1,
    }
    assert found.controllers["states"] == {
        "type": "joint_state_controller/JointStateController",
        "publish_rate": 50.0,
        "command_timeout": 0.5,
    }
    assert found.controllers["force"]["sensor_name"] == "wrist"
    assert found.others["controller_manager"]["update_rate"] == 500


@pytest.mark.parametrize(
    ("key", "fits"),
    [
        ("/**", True),
        ("/**/arm", True),
        ("/*/arm", True),
        ("/left/arm", True),
        ("/left/**", True),
        ("/*", False),
        ("/right/arm", False),
        ("/left/*/arm", False),
        ("arm", False),
    ],
)
def test_a_wildcard_stands_for_names(key, fits):
    found = read(f"""
/left/controller_manager: {{ros__parameters: {{arm: {{type: a/B}}}}}}
"{key}": {{ros__parameters: {{joint: j1}}}}
""")

    expected = {"type": "a/B", "joint": "j1"} if fits else {"type": "a/B"}
    assert found.controllers == {"arm": expected}


def test_files_say_together_what_one_would():
    types = {"/**/controller_manager": {"ros__parameters": {"arm": {"type": "a/B"}}}}
    more = {"/**/arm": {"ros__parameters": {"joint": "j1"}}}

    assert join_ros2([types, more], "f").controllers == {
        "arm": {"type": "a/B", "joint": "j1"}
    }


def test_a_namespace_may_have_several_blocks():
    text = """
/**: {controller_manager: {ros__parameters: {arm: {type: a/B}}}}
/**: {arm: {ros__parameters: {joint: j1}}}
"""
    found = split_ros_parameters(parse_yaml(text, "f.yaml").values, "f.yaml")

    assert found.controllers == {"arm": {"type": "a/B", "joint": "j1"}}
    with pytest.raises(ConfigError, match="twice"):
        parse_yaml(text + "/**: {arm: 3}", "f.yaml")
    with pytest.raises(ConfigError, match="twice"):
        parse_yaml("arm: {a: 1}\narm: {b: 2}", "f.yaml")


def test_equal_names_have_their_namespaces_in_front():
    found = read("""
left:
  controller_manager: {ros__parameters: {arm: {type: a/B}, hand: {type: a/C}}}
  arm: {ros__parameters: {joint: l1}}
right:
  controller_manager: {ros__parameters: {arm: {type: a/B}}}
  arm: {ros__parameters: {joint: r1}}
/**/arm: {ros__parameters: {goal_tolerance: 0.1}}
""")

    assert found.controllers == {
        "left_arm": {"type": "a/B", "joint": "l1", "goal_tolerance": 0.1},
        "right_arm": {"type": "a/B", "joint": "r1", "goal_tolerance": 0.1},
        "hand": {"type": "a/C"},
    }


def test_a_controller_may_name_its_type_itself():
    found = read("arm: {ros__parameters: {type: a/B, joint: j1}}")

    assert found.controllers == {"arm": {"type": "a/B", "joint": "j1"}}


def test_fallbacks_may_be_those_of_the_manager_or_of_the_controller():
    found = read("""
controller_manager:
  ros__parameters:
    arm: {type: a/B, fallback_controllers: [hold]}
    hand.fallback_controllers: [rest]
    base: {type: a/B}
hand: {ros__parameters: {type: a/C}}
base: {ros__parameters: {fallback_controllers: [brake, lamp]}}
""")

    assert found.controllers == {
        "arm": {"type": "a/B", "fallback": ["hold"]},
        "hand": {"type": "a/C", "fallback": ["rest"]},
        "base": {"type": "a/B", "fallback": ["brake", "lamp"]},
    }


@pytest.mark.parametrize(
    ("more", "joints"),
    [
        ("joints: [j1]", None),
        ("joints: [j1], interfaces: [position]", ["j1"]),
        ("interfaces: [position]", None),
        ("joints: []", None),
    ],
)
def test_all_joints_are_published_unless_joints_and_interfaces_are_listed(more, joints):
    kind = "joint_state_broadcaster/JointStateBroadcaster"
    text = f"s: {{ros__parameters: {{type: {kind}, extra_joints: [x, y], {more}}}}}"
    found = read(text).controllers["s"]

    assert found.get("joints") == joints
    assert "interfaces" not in found
    assert found["extra_joints"] == [{"name": "x"}, {"name": "y"}]


@pytest.mark.parametrize(
    ("interfaces", "kind"),
    [
        ("[position]", "position_controllers"),
        ("[velocity]", "velocity_controllers"),
        ("[position, velocity]", "pos_vel_controllers"),
        ("[position, velocity, acceleration]", "pos_vel_acc_controllers"),
    ],
)
def test_the_commanded_interfaces_choose_the_type(interfaces, kind):
    found = read(f"""
arm:
  ros__parameters:
    type: joint_trajectory_controller/JointTrajectoryController
    joints: [j1]
    command_interfaces: {interfaces}
""")

    assert found.controllers["arm"]["type"] == f"{kind}/JointTrajectoryController"


def test_a_base_keeps_the_names_of_ros2():
    found = read("""
base:
  ros__parameters:
    type: diff_drive_controller/DiffDriveController
    left_wheel_names: [l]
    right_wheel_names: [r]
    linear.x.max_velocity: 1.5
    angular: {z: {max_velocity: 2.0, has_velocity_limits: false}}
""").controllers["base"]

    assert found["left_wheel_names"] == ["l"]
    assert found["linear"]["x"] == {"max_velocity": 1.5}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("arm: {ros__parameters: 3}", "/arm/ros__parameters is 3"),
        (FILE.replace("[effort]", "[voltage]"), "interfaces are .'voltage'."),
        (FILE.replace("    command_interfaces: [effort]\n", ""), "interfaces are None"),
        (FILE.replace("gains.j1: {p: 10.0", "gains: {p: 10.0"), "gains/p is 10.0"),
        (FILE.replace("gains.j1: {", "velocity_ff: 3\n    gains.j1: {"), "_ff is 3"),
        (FILE.replace("gains.j1:", "gains: 5\n    more:").replace("gains.j2", "no"),
         "arm: gains is 5"),
        (FILE.replace("ros__parameters:\n    joints", "ros_parameters:\n    joints"),
         "arm/ros_parameters has no effect. Did you mean 'ros__parameters'"),
        ("a: {ros_parameters: {b: {type: p/T}}}", "Did you mean 'ros__parameters'"),
        (MANAGER.format("{type: [p/T]}"), "controller_manager/a/type is .'p/T'."),
        (MANAGER.format("{typ: p/T}"), "controller_manager/a/typ has no effect"),
        (MANAGER.format("p/Type"), "controller_manager/a is 'p/Type'"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_refused(text, words):
    with pytest.raises(ConfigError, match=words):
        read(text)


def test_variables_are_those_of_the_configuration(tmp_path):
    path = tmp_path / "ur.yaml"
    path.write_text("""
controller_manager:
  ros__parameters:
    arm: {type: ur_controllers/ScaledJointTrajectoryController}
arm:
  ros__parameters:
    joints: [$(var tf_prefix)elbow]
    command_interfaces: [position]
""")
    found = load_config(
        None, controller_files=[path], flags={"arguments.tf_prefix": "left_"}
    ).controller_parameters()["arm"]
    assert found["joints"] == ["left_elbow"]
    assert found["type"] == "position_controllers/JointTrajectoryController"
    bare = load_config({"arguments": {"tf_prefix": ""}}, controller_files=[path])
    assert bare.controller_parameters()["arm"]["joints"] == ["elbow"]
    with pytest.raises(ConfigError, match=r"\$\(var tf_prefix\)"):
        load_config(None, controller_files=[path])


def test_types_may_be_those_of_the_stations_own_file(tmp_path):
    path = tmp_path / "base.yaml"
    path.write_text("""
base:
  ros__parameters:
    left_wheel_names: [l]
    right_wheel_names: [r]
    left_wheel_radius_multiplier: 1.1
    right_wheel_radius_multiplier: 1.1
""")
    kind = "diff_drive_controller/DiffDriveController"
    found = load_config(
        {"controllers": {"base": {"type": kind}}}, controller_files=[path]
    ).controller_parameters()["base"]
    assert found == {
        "type": kind,
        "left_wheel_names": ["l"],
        "right_wheel_names": ["r"],
        "left_wheel_radius_multiplier": 1.1,
        "right_wheel_radius_multiplier": 1.1,
    }


def test_examples_of_franka_get_the_arm_of_the_robot(tmp_path):
    path = tmp_path / "franka.yaml"
    kinds = ("JointPosition", "CartesianPose", "JointImpedance")
    path.write_text(
        "controller_manager:\n  ros__parameters:\n"
        + "".join(
            f"    e{n}: {{type: franka_example_controllers/{kind}ExampleController}}\n"
            for n, kind in enumerate(kinds)
        )
    )
    robot = {"type": "franka_hw/FrankaHW", "arm_id": "fr3"}
    found = load_config({"robot": robot}, controller_files=[path])
    position, pose, impedance = (
        found.controller_parameters()[f"e{n}"] for n in range(3)
    )
    assert "arm_id" not in position
    assert position["joint_names"][6] == "fr3_joint7"
    assert (pose["arm_id"], "joint_names" in pose) == ("fr3", False)
    assert impedance.keys() == {"type", "arm_id", "joint_names"}
