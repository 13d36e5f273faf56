"""The controllers of ros_controls, by the type names of the original packages.

`CONTROLLERS` maps a type to `module:Class`; modules are imported when a controller
of the type is loaded.
"""

_MODULES = {
    "admittance_controller/AdmittanceController": "admittance_controller",
    "battery_state_broadcaster/BatteryStateBroadcaster": "sensor_controllers",
    "chained_filter_controller/ChainedFilter": "chained_filter_controller",
    "diff_drive_controller/DiffDriveController": "diff_drive_controller",
    "effort_controllers/GripperActionController": "gripper_action_controller:Effort",
    "effort_controllers/JointEffortController": "effort_controllers",
    "effort_controllers/JointGroupEffortController": "effort_controllers",
    "effort_controllers/JointGroupPositionController": "effort_controllers",
    "effort_controllers/JointJogController": "smoothed_motion:Effort",
    "effort_controllers/JointStreamingController": "smoothed_motion:Effort",
    "effort_controllers/JointTrajectoryController": (
        "joint_trajectory_controller:Effort"
    ),
    "effort_controllers/JointPositionController": "effort_controllers",
    "effort_controllers/JointVelocityController": "effort_controllers",
    "force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster": (
        "sensor_controllers"
    ),
    "force_torque_sensor_controller/ForceTorqueSensorController": (
        "sensor_controllers"
    ),
    "franka_controllers/CartesianJogController": "cartesian_motion",
    "franka_controllers/CartesianStreamingController": "cartesian_motion",
    "franka_example_controllers/CartesianImpedanceExampleController": (
        "franka_example_controllers"
    ),
    "franka_example_controllers/CartesianPoseExampleController": (
        "franka_example_controllers"
    ),
    "franka_example_controllers/CartesianVelocityExampleController": (
        "franka_example_controllers"
    ),
    "franka_example_controllers/DualArmCartesianImpedanceExampleController": (
        "franka_example_controllers"
    ),
    "franka_example_controllers/ElbowExampleController": "franka_example_controllers",
    "franka_example_controllers/ForceExampleController": "franka_example_controllers",
    "franka_example_controllers/JointImpedanceExampleController": (
        "franka_example_controllers"
    ),
    "franka_example_controllers/JointPositionExampleController": (
        "franka_example_controllers"
    ),
    "franka_example_controllers/JointVelocityExampleController": (
        "franka_example_controllers"
    ),
    "franka_example_controllers/ModelExampleController": "franka_example_controllers",
    "franka_example_controllers/TeleopJointPDExampleController": (
        "franka_example_controllers"
    ),
    "franka_control/FrankaStateController": "franka_state_controller",
    "gpio_controllers/GpioCommandController": "gpio_controllers",
    "gps_sensor_broadcaster/GPSSensorBroadcaster": "sensor_controllers",
    "impedance_controllers/CartesianImpedanceController": "impedance_controllers",
    "impedance_controllers/JointImpedanceController": "impedance_controllers",
    "imu_sensor_controller/ImuSensorController": "sensor_controllers",
    "joint_state_controller/JointStateController": "joint_state_controller",
    "magnetometer_broadcaster/MagnetometerBroadcaster": "sensor_controllers",
    "parallel_gripper_action_controller/GripperActionController": (
        "gripper_action_controller:Parallel"
    ),
    "pid_controller/PidController": "pid_controller",
    "pos_vel_controllers/JointTrajectoryController": (
        "joint_trajectory_controller:PosVel"
    ),
    "pos_vel_acc_controllers/JointTrajectoryController": (
        "joint_trajectory_controller:PosVelAcc"
    ),
    "position_controllers/GripperActionController": (
        "gripper_action_controller:Position"
    ),
    "position_controllers/JointGroupPositionController": "position_controllers",
    "position_controllers/JointJogController": "smoothed_motion:Position",
    "position_controllers/JointStreamingController": "smoothed_motion:Position",
    "position_controllers/JointTrajectoryController": (
        "joint_trajectory_controller:Position"
    ),
    "position_controllers/JointPositionController": "position_controllers",
    "range_sensor_broadcaster/RangeSensorBroadcaster": "sensor_controllers",
    "velocity_controllers/JointGroupVelocityController": "velocity_controllers",
    "velocity_controllers/JointTrajectoryController": (
        "joint_trajectory_controller:Velocity"
    ),
    "velocity_controllers/JointPositionController": "velocity_controllers",
    "velocity_controllers/JointVelocityController": "velocity_controllers",
}
"""Module of each type. The class has the name of the type; a prefix of that name
follows after `:` where types of several packages share the module."""


def _class_of(controller_type: str) -> str:
    module, _, prefix = _MODULES[controller_type].partition(":")
    name = controller_type.rpartition("/")[2]
    return f"{__name__}.{module}:{prefix}{name}"


CONTROLLERS: dict[str, str] = {each: _class_of(each) for each in _MODULES}

__all__ = ["CONTROLLERS"]
