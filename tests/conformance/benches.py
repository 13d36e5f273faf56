"""Robots and parameters with which everything in the tables can run."""

from collections.abc import Mapping
from functools import cache

from station.controllers import CONTROLLERS
from station.core.clock import ManualClock
from station.core.control.controller_loader import TableLoader
from station.core.control.controller_manager import ControllerManager
from station.core.description.robot_files import RobotFiles, load_robot_files
from station.core.errors import ControllerLoadError
from station.core.parameters import Parameters
from station.hw.robot_loader import create_robot

PERIOD = 0.001
JOINTS = [f"panda_joint{number}" for number in range(1, 8)]
POSE = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785]
"""A pose within the limits of the Panda [rad]."""
OTHER_JOINTS = [f"other_joint{number}" for number in range(1, 8)]
"""Those of the second arm of two."""

MOCK = {"joints": JOINTS, "initial_positions": POSE}
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
    "k_gains": [600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0],
    "d_gains": [50.0, 50.0, 50.0, 20.0, 20.0, 20.0, 10.0],
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


@cache
def panda() -> RobotFiles:
    """Return the description of the Panda, read once."""
    return load_robot_files("example-robot-data:panda")


class Bench:
    """One robot with its manager; cycles are run by hand.

    Args:
        robot_type: A key of `HARDWARE`.
    """

    def __init__(self, robot_type: str = "mock_hw/MockRobotHW") -> None:
        self.clock = ManualClock()
        self.parameters = Parameters()
        if robot_type != "franka_hw/FrankaCombinedHW":  # which describes both arms
            self.parameters.set("robot_description", panda().xml)
        self.robot = create_robot(robot_type)
        self.parameters.set("hw", dict(ROBOT_PARAMETERS.get(robot_type, {})))
        self.robot.init(self.parameters, self.parameters.namespace("hw"))
        self.manager = ControllerManager(
            self.robot, self.parameters, [TableLoader(CONTROLLERS)], self.clock
        )
        self.manager.pump = self.step
        self.time = 0.0

    def step(self, cycles: int = 1) -> None:
        """Run cycles."""
        for _ in range(cycles):
            self.time += PERIOD
            self.robot.read(self.time, PERIOD)
            self.manager.update(self.time, PERIOD)
            self.robot.write(self.time, PERIOD)

    def pause(self, cycles: int = 1) -> None:
        """Run cycles in which simulated time stands still."""
        for _ in range(cycles):
            self.robot.read(self.time, 0.0)
            self.manager.update(self.time, 0.0)
            self.robot.write(self.time, 0.0)

    def resting_set_point(self) -> list[float]:
        """Return a set-point with which hardly anything moves."""
        controller = self.manager.get_controller("it")
        port = controller.set_points
        names = [] if port is None else [element.name for element in port.elements]
        if "qw" in names:
            quaternion = {"qx": 1.0}
            position = {"x": 0.307, "z": 0.487}
            return [{**quaternion, **position}.get(name, 0.0) for name in names]
        units = [] if port is None else [element.unit for element in port.elements]
        return [
            POSE[JOINTS.index(name)] if unit == "rad" else 0.0
            for name, unit in zip(names, units, strict=True)
        ]

    def load(self, controller_type: str, **more: object) -> None:
        """Load a controller under the name `it`, with more parameters."""
        self.parameters.set(
            "it", {**CONTROLLER_PARAMETERS, "type": controller_type, **more}
        )
        self.manager.load_controller("it")

    def commands(self) -> list[float]:
        """Return every command of every interface of the robot."""
        commands: list[float] = []
        for interface_type in self.robot.interface_types():
            interface = self.robot.get(interface_type)
            for handle in getattr(interface, "handles", list)():
                commands += [storage[i] for storage, i in handle.command_slots()]
        return commands


def bench_for(controller_type: str, **more: object) -> Bench:
    """Return a bench with the controller loaded: the mock, or else Franka arms.

    Args:
        controller_type: A key of `CONTROLLERS`.
        more: More parameters of the controller.
    """
    if controller_type in TWO_ARMED:
        bench = Bench("franka_hw/FrankaCombinedHW")
        bench.load(controller_type, **more)
        return bench
    bench = Bench()
    try:
        bench.load(controller_type, **more)
    except ControllerLoadError as error:
        if "hardware_interface" not in error.details:
            raise
        bench = Bench("franka_hw/FrankaHW")
        bench.load(controller_type, **more)
    return bench
