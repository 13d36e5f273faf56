"""The Franka hand: finger joints, gripper services, motions of the fingers."""
