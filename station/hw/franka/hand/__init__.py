"""The Franka hand: fingers, gripper services, the simulated gripper."""
