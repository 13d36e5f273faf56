"""Packages of ROS whose controllers this station does not have."""

CONTROLLER_ORIGINS = {
    "ackermann_steering_controller": "ros_controllers (ros-controls/ros_controllers)",
    "four_wheel_steering_controller": "ros_controllers (ros-controls/ros_controllers)",
    "rqt_joint_trajectory_controller": "ros_controllers (ros-controls/ros_controllers)",
    "velocity_controllers": "ros_controllers (ros-controls/ros_controllers)",
    "robot_controllers": "robot_controllers of Fetch (fetchrobotics/robot_controllers)",
    "pr2_controller_manager": "pr2_mechanism (PR2/pr2_mechanism)",
    "pr2_mechanism_controllers": "pr2_controllers (PR2/pr2_controllers)",
    "JointTrajectoryActionController": "pr2_controllers (PR2/pr2_controllers)",
    "robot_mechanism_controllers": "pr2_controllers (PR2/pr2_controllers)",
    "unitree_legged_control": "unitree_ros (unitreerobotics/unitree_ros)",
    "baxter_sim_controllers": "baxter_simulator (RethinkRobotics/baxter_simulator)",
    "scaled_controllers": "scaled_joint_trajectory_controller and its interface "
    "(UniversalRobots/Universal_Robots_ROS_scaled_controllers)",
    "ur_controllers": "ur_robot_driver (UniversalRobots/Universal_Robots_ROS_Driver)",
    "cartesian_trajectory_controllers": "cartesian_trajectory_controllers "
    "(UniversalRobots/Universal_Robots_ROS_controllers_cartesian)",
    "speed_scaling_state_controller": "scaled controllers "
    "(UniversalRobots/Universal_Robots_ROS_scaled_controllers)",
    "passthrough_controllers": "Universal_Robots_ROS_passthrough_controllers",
    "temperature_sensor_controller": "PAL's controllers (pal-robotics)",
    "imu_sensor_controller": "ros_controllers (ros-controls/ros_controllers)",
    "mecanum_drive_controller": "mecanum_drive_controller "
    "(RobotnikAutomation/mecanum_drive_controller)",
    "jog_controller": "jog_control (tork-a/jog_control)",
    "industrial_robot_status_controller": "industrial_robot_status_controller "
    "(gavanderhoorn/industrial_robot_status_controller)",
    "play_motion": "play_motion (pal-robotics/play_motion)",
}
"""Where the types of a package come from."""
