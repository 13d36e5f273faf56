"""The controllers of ros_controls, by the type names of the original packages.

`CONTROLLERS` maps a type to `module:Class`; modules are imported when a controller
of the type is loaded.
"""

CONTROLLERS: dict[str, str] = {
    "effort_controllers/JointGroupEffortController": (
        "station.controllers.effort_controllers:JointGroupEffortController"
    ),
    "effort_controllers/JointGroupPositionController": (
        "station.controllers.effort_controllers:JointGroupPositionController"
    ),
    "joint_state_controller/JointStateController": (
        "station.controllers.joint_state_controller:JointStateController"
    ),
    "position_controllers/JointGroupPositionController": (
        "station.controllers.position_controllers:JointGroupPositionController"
    ),
    "velocity_controllers/JointGroupVelocityController": (
        "station.controllers.velocity_controllers:JointGroupVelocityController"
    ),
}

__all__ = ["CONTROLLERS"]
