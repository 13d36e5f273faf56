"""Hardware as ros_control sees it: interfaces, limits, transmissions, robots."""
