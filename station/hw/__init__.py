"""Robots: everything that implements `RobotHW`.

`HARDWARE` is the table of robot types: type as configured, then where its class is. A
module is imported only when its robot is asked for, so that a missing library of one
robot does not concern the others.
"""

HARDWARE: dict[str, str] = {
    "combined_robot_hw/CombinedRobotHW": (
        "station.hw.combined_robot_hw:CombinedRobotHW"
    ),
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
