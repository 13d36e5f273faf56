"""The controllers of ros_controls, by the type names of the original packages.

`CONTROLLERS` maps a type to `module:Class`; modules are imported when a controller
of the type is loaded.
"""

CONTROLLERS: dict[str, str] = {
    "admittance_controller/AdmittanceController": (
        "station.controllers.admittance_controller:AdmittanceController"
    ),
    "battery_state_broadcaster/BatteryStateBroadcaster": (
        "station.controllers.semantic_sensor_broadcasters:BatteryStateBroadcaster"
    ),
    "chained_filter_controller/ChainedFilter": (
        "station.controllers.chained_filter_controller:ChainedFilter"
    ),
    "diff_drive_controller/DiffDriveController": (
        "station.controllers.diff_drive_controller:DiffDriveController"
    ),
    "effort_controllers/GripperActionController": (
        "station.controllers.gripper_action_controller:EffortGripperActionController"
    ),
    "effort_controllers/JointEffortController": (
        "station.controllers.effort_controllers:JointEffortController"
    ),
    "effort_controllers/JointGroupEffortController": (
        "station.controllers.effort_controllers:JointGroupEffortController"
    ),
    "effort_controllers/JointGroupPositionController": (
        "station.controllers.effort_controllers:JointGroupPositionController"
    ),
    "effort_controllers/JointJogController": (
        "station.controllers.smoothed_motion:EffortJointJogController"
    ),
    "effort_controllers/JointStreamingController": (
        "station.controllers.smoothed_motion:EffortJointStreamingController"
    ),
    "effort_controllers/JointTrajectoryController": (
        "station.controllers.joint_trajectory_controller"
        ":EffortJointTrajectoryController"
    ),
    "effort_controllers/JointPositionController": (
        "station.controllers.effort_controllers:JointPositionController"
    ),
    "effort_controllers/JointVelocityController": (
        "station.controllers.effort_controllers:JointVelocityController"
    ),
    "force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster": (
        "station.controllers.force_torque_sensor_controller:ForceTorqueSensorBroadcaster"
    ),
    "force_torque_sensor_controller/ForceTorqueSensorController": (
        "station.controllers.force_torque_sensor_controller:ForceTorqueSensorController"
    ),
    "franka_controllers/CartesianJogController": (
        "station.controllers.cartesian_motion:CartesianJogController"
    ),
    "franka_controllers/CartesianStreamingController": (
        "station.controllers.cartesian_motion:CartesianStreamingController"
    ),
    "franka_example_controllers/CartesianImpedanceExampleController": (
        "station.controllers.franka_example_controllers:CartesianImpedanceExampleController"
    ),
    "franka_example_controllers/CartesianPoseExampleController": (
        "station.controllers.franka_example_controllers:CartesianPoseExampleController"
    ),
    "franka_example_controllers/CartesianVelocityExampleController": (
        "station.controllers.franka_example_controllers:CartesianVelocityExampleController"
    ),
    "franka_example_controllers/DualArmCartesianImpedanceExampleController": (
        "station.controllers.franka_example_controllers:DualArmCartesianImpedanceExampleController"
    ),
    "franka_example_controllers/ElbowExampleController": (
        "station.controllers.franka_example_controllers:ElbowExampleController"
    ),
    "franka_example_controllers/ForceExampleController": (
        "station.controllers.franka_example_controllers:ForceExampleController"
    ),
    "franka_example_controllers/JointImpedanceExampleController": (
        "station.controllers.franka_example_controllers:JointImpedanceExampleController"
    ),
    "franka_example_controllers/JointPositionExampleController": (
        "station.controllers.franka_example_controllers:JointPositionExampleController"
    ),
    "franka_example_controllers/JointVelocityExampleController": (
        "station.controllers.franka_example_controllers:JointVelocityExampleController"
    ),
    "franka_example_controllers/ModelExampleController": (
        "station.controllers.franka_example_controllers:ModelExampleController"
    ),
    "franka_example_controllers/TeleopJointPDExampleController": (
        "station.controllers.franka_example_controllers:TeleopJointPDExampleController"
    ),
    "franka_control/FrankaStateController": (
        "station.controllers.franka_state_controller:FrankaStateController"
    ),
    "gpio_controllers/GpioCommandController": (
        "station.controllers.gpio_controllers:GpioCommandController"
    ),
    "gps_sensor_broadcaster/GPSSensorBroadcaster": (
        "station.controllers.semantic_sensor_broadcasters:GPSSensorBroadcaster"
    ),
    "impedance_controllers/CartesianImpedanceController": (
        "station.controllers.impedance_controllers:CartesianImpedanceController"
    ),
    "impedance_controllers/JointImpedanceController": (
        "station.controllers.impedance_controllers:JointImpedanceController"
    ),
    "imu_sensor_controller/ImuSensorController": (
        "station.controllers.imu_sensor_controller:ImuSensorController"
    ),
    "joint_state_controller/JointStateController": (
        "station.controllers.joint_state_controller:JointStateController"
    ),
    "magnetometer_broadcaster/MagnetometerBroadcaster": (
        "station.controllers.semantic_sensor_broadcasters:MagnetometerBroadcaster"
    ),
    "parallel_gripper_action_controller/GripperActionController": (
        "station.controllers.gripper_action_controller:ParallelGripperActionController"
    ),
    "pid_controller/PidController": (
        "station.controllers.pid_controller:PidController"
    ),
    "pos_vel_controllers/JointTrajectoryController": (
        "station.controllers.joint_trajectory_controller"
        ":PosVelJointTrajectoryController"
    ),
    "pos_vel_acc_controllers/JointTrajectoryController": (
        "station.controllers.joint_trajectory_controller"
        ":PosVelAccJointTrajectoryController"
    ),
    "position_controllers/GripperActionController": (
        "station.controllers.gripper_action_controller:PositionGripperActionController"
    ),
    "position_controllers/JointGroupPositionController": (
        "station.controllers.position_controllers:JointGroupPositionController"
    ),
    "position_controllers/JointJogController": (
        "station.controllers.smoothed_motion:PositionJointJogController"
    ),
    "position_controllers/JointStreamingController": (
        "station.controllers.smoothed_motion:PositionJointStreamingController"
    ),
    "position_controllers/JointTrajectoryController": (
        "station.controllers.joint_trajectory_controller"
        ":PositionJointTrajectoryController"
    ),
    "position_controllers/JointPositionController": (
        "station.controllers.position_controllers:JointPositionController"
    ),
    "range_sensor_broadcaster/RangeSensorBroadcaster": (
        "station.controllers.semantic_sensor_broadcasters:RangeSensorBroadcaster"
    ),
    "velocity_controllers/JointGroupVelocityController": (
        "station.controllers.velocity_controllers:JointGroupVelocityController"
    ),
    "velocity_controllers/JointTrajectoryController": (
        "station.controllers.joint_trajectory_controller"
        ":VelocityJointTrajectoryController"
    ),
    "velocity_controllers/JointPositionController": (
        "station.controllers.velocity_controllers:JointPositionController"
    ),
    "velocity_controllers/JointVelocityController": (
        "station.controllers.velocity_controllers:JointVelocityController"
    ),
}

__all__ = ["CONTROLLERS"]
