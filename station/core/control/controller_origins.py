"""Packages of ROS with controllers that this station does not have."""

CONTROLLER_ORIGINS = {
    "ackermann_steering_controller": "ros_controllers (ros-controls/ros_controllers)",
    "four_wheel_steering_controller": "ros_controllers (ros-controls/ros_controllers)",
    "robot_controllers": "robot_controllers of Fetch (fetchrobotics/robot_controllers)",
    "pr2_mechanism_controllers": "pr2_controllers (PR2/pr2_controllers)",
    "robot_mechanism_controllers": "pr2_controllers (PR2/pr2_controllers)",
    "unitree_legged_control": "unitree_ros (unitreerobotics/unitree_ros)",
    "baxter_sim_controllers": "baxter_simulator (RethinkRobotics/baxter_simulator)",
    "scaled_controllers": "the scaled controllers of Universal Robots "
    "(UniversalRobots/Universal_Robots_ROS_scaled_controllers)",
    "ur_controllers": "ur_robot_driver (UniversalRobots/Universal_Robots_ROS_Driver)",
    "passthrough_controllers": "the passthrough controllers of Universal Robots "
    "(UniversalRobots/Universal_Robots_ROS_passthrough_controllers)",
    "industrial_robot_status_controller": "industrial_robot_status_controller "
    "(gavanderhoorn/industrial_robot_status_controller)",
}
"""Where the types of a package come from, by the part of a type before the slash."""
