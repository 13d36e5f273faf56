"""Robots and parameters with which everything in the tables can run."""

from collections.abc import Mapping
from functools import cache

from station.core.description.robot_files import RobotFiles, load_robot_files
from station.core.errors import ControllerLoadError
from station.hw.robot_loader import create_robot
from station.testing import Bench

JOINTS = [f"panda_joint{number}" for number in range(1, 8)]
POSE = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785]
"""A pose within the limits of the Panda [rad]."""
OTHER_JOINTS = [f"other_joint{number}" for number in range(1, 8)]
"""Those of the second arm of two."""

SENSORS = ("range", "magnetometer", "gps", "battery")
MOCK = {
    "joints": JOINTS,
    "initial_positions": POSE,
    "sensors": {f"mock_{kind}": {"type": kind} for kind in SENSORS},
    "gpios": {"io": {"command_interfaces": ["out"], "state_interfaces": ["out"]}},
}
FRANKA = {
    "arm_id": "panda",
    "joint_names": JOINTS,
    "robot_description": "example-robot-data:panda",
}
ROBOT_PARAMETERS: Mapping[str, Mapping[str, object]] = {
    "mock_hw/MockRobotHW": MOCK,
    "franka_hw/FrankaHW": FRANKA,
    "franka_hw/FrankaCombinableHW": FRANKA,
    "franka_hw/FrankaCombinedHW": {
        "robot_hardware": ["arm", "second"],
        "arm": FRANKA,
        "second": {
            "arm_id": "other",
            "joint_names": OTHER_JOINTS,
            "robot_description": "example-robot-data:panda",
            "base_xyz": [0.0, 1.0, 0.0],
        },
    },
    "mujoco_hw/MujocoRobotHW": {
        "robot_description": "example-robot-data:panda",
        # With its other joints at 0 the arm would touch itself.
        "initial_positions": {"panda_joint4": -2.0, "panda_joint6": 2.0},
    },
    "combined_robot_hw/CombinedRobotHW": {
        "robot_hardware": ["left"],
        "left": {"type": "mock_hw/MockRobotHW", **MOCK},
    },
}
"""Parameters a robot of the table needs; none for a type that is not listed."""

ONE_ARM = {"arm_id": "panda", "joint_names": JOINTS}
OTHER_ARM = {"arm_id": "other", "joint_names": OTHER_JOINTS}
TWO_ARMED = (
    "franka_example_controllers/DualArmCartesianImpedanceExampleController",
    "franka_example_controllers/TeleopJointPDExampleController",
)
"""Types of controllers that need two arms."""

PID = {"p": 10.0, "i": 0.0, "d": 1.0}
CONTROLLER_PARAMETERS: Mapping[str, object] = {
    "arm_id": "panda",
    "joint": JOINTS[0],
    "joints": JOINTS,
    "joint_names": JOINTS,
    "pid": PID,
    "gains": dict.fromkeys(JOINTS, PID),
    "publish_rate": 50.0,
    "dof_names": JOINTS,
    "command_interface": "effort",
    "reference_and_state_interfaces": ["position", "velocity"],
    "sensor_name": "mock_wrench",
    "command_interfaces": ["position"],
    "kinematics": {"base": "panda_link0", "tip": "panda_hand"},
    "ft_sensor": {"name": "mock_wrench", "frame": {"id": "panda_hand"}},
    "control": {"frame": {"id": "panda_hand"}},
    "fixed_world_frame": {"frame": {"id": "panda_link0"}},
    "gravity_compensation": {
        "frame": {"id": "panda_hand"},
        "CoG": {"pos": [0.0, 0.0, 0.0]},
    },
    "admittance": {
        "selected_axes": [True] * 6,
        "mass": [5.0] * 6,
        "damping_ratio": [1.0] * 6,
        "stiffness": [100.0] * 6,
    },
    "k_gains": [600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0],
    "d_gains": [50.0, 50.0, 50.0, 20.0, 20.0, 20.0, 10.0],
    "left_wheel": JOINTS[0],
    "right_wheel": [JOINTS[1]],
    "wheel_separation": 0.5,
    "wheel_radius": 0.1,
    "left": ONE_ARM,
    "right": OTHER_ARM,
    "leader": {
        **ONE_ARM,
        "d_gains_lower": [1.0, 1.0, 1.0, 1.0, 0.33, 0.33, 0.17],
        "d_gains_upper": [35.0, 35.0, 35.0, 35.0, 10.0, 10.0, 8.0],
        "dq_max_lower": [1.3, 1.3, 1.3, 1.3, 1.4, 1.4, 1.4],
        "dq_max_upper": [1.9, 1.9, 1.9, 1.9, 2.2, 2.2, 2.2],
        "contact_force_threshold": 4.0,
    },
    "follower": {
        **OTHER_ARM,
        "p_gains": [900.0, 900.0, 900.0, 900.0, 375.0, 225.0, 100.0],
        "d_gains": [45.0, 45.0, 45.0, 45.0, 15.0, 15.0, 10.0],
        "drift_comp_gains": [4.3] * 7,
        "dq_max_lower": [0.8, 0.8, 0.8, 0.8, 2.5, 2.5, 2.5],
        "dq_max_upper": [2.0, 2.0, 2.0, 2.0, 2.5, 2.5, 2.5],
        "ddq_max_lower": [0.8, 0.8, 0.8, 0.8, 10.0, 10.0, 10.0],
        "ddq_max_upper": [6.0, 6.0, 6.0, 6.0, 15.0, 20.0, 20.0],
        "contact_force_threshold": 5.0,
    },
    **{name: {"pid": PID} for name in JOINTS},
}
"""Everything a controller of the table may ask for."""


MEAN = {"type": "filters/MeanFilterDouble", "params": {"number_of_observations": 2}}
PARAMETERS_OF_TYPES: Mapping[str, Mapping[str, object]] = {
    "range_sensor_broadcaster/RangeSensorBroadcaster": {"sensor_name": "mock_range"},
    "magnetometer_broadcaster/MagnetometerBroadcaster": {
        "sensor_name": "mock_magnetometer"
    },
    "gps_sensor_broadcaster/GPSSensorBroadcaster": {"sensor_name": "mock_gps"},
    "battery_state_broadcaster/BatteryStateBroadcaster": {
        "batteries": ["mock_battery"]
    },
    "gpio_controllers/GpioCommandController": {
        "gpios": ["io"],
        "command_interfaces": {"io": {"interfaces": ["out"]}},
    },
    "chained_filter_controller/ChainedFilter": {
        "input_interfaces": ["mock_range/range"],
        "output_interfaces": ["range"],
        "filter_chain": {"filter1": MEAN},
    },
}
"""What controllers of one type ask for instead."""


@cache
def panda() -> RobotFiles:
    """Return the description of the Panda, read once."""
    return load_robot_files("example-robot-data:panda")


def robot_bench(robot_type: str = "mock_hw/MockRobotHW") -> Bench:
    """Return a bench with a robot of the table.

    Args:
        robot_type: A key of `HARDWARE`.
    """
    # Two arms describe themselves.
    root = {"robot_description": panda().xml}
    return Bench(
        create_robot(robot_type),
        ROBOT_PARAMETERS.get(robot_type),
        root_parameters={} if robot_type == "franka_hw/FrankaCombinedHW" else root,
    )


def bench_for(controller_type: str, **more: object) -> Bench:
    """Return a bench with the controller loaded: the mock, or else Franka arms.

    Args:
        controller_type: A key of `CONTROLLERS`.
        more: More parameters of the controller.
    """
    bench = robot_bench(robot_for(controller_type))
    bench.load_controller("it", controller_type, **_parameters(controller_type, more))
    return bench


@cache
def robot_for(controller_type: str) -> str:
    """Return the type of the robot that has what a controller claims.

    Args:
        controller_type: A key of `CONTROLLERS`.
    """
    if controller_type in TWO_ARMED:
        return "franka_hw/FrankaCombinedHW"
    parameters = _parameters(controller_type, {})
    try:
        robot_bench().load_controller("it", controller_type, **parameters)
    except ControllerLoadError as error:
        if "hardware_interface" not in error.details:
            raise
        return "franka_hw/FrankaHW"
    return "mock_hw/MockRobotHW"


def _parameters(controller_type: str, more: Mapping[str, object]) -> dict[str, object]:
    special = PARAMETERS_OF_TYPES.get(controller_type, {})
    return {**CONTROLLER_PARAMETERS, **special, **more}
