"""Robots: everything that implements `RobotHW`.

`HARDWARE` is the table of robot types: the type as configured, then the place of its
class. A module is imported only when its robot is needed, so that a missing library
concerns only the robots that use it.
"""

HARDWARE: dict[str, str] = {
    "combined_robot_hw/CombinedRobotHW": ("station.hw.robot_loader:CombinedRobotHW"),
    "franka_hw/FrankaCombinableHW": (
        "station.hw.franka.franka_combined_hw:FrankaCombinableHW"
    ),
    "franka_hw/FrankaCombinedHW": (
        "station.hw.franka.franka_combined_hw:FrankaCombinedHW"
    ),
    "franka_hw/FrankaHW": "station.hw.franka.franka_hw:FrankaHW",
    "mock_hw/MockRobotHW": "station.hw.mock:MockRobotHW",
    "mujoco_hw/MujocoRobotHW": "station.hw.mujoco.mujoco_robot_hw:MujocoRobotHW",
}
