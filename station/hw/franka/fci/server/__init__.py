"""The robot's side of the Franka Control Interface, with a simulated arm behind it."""
