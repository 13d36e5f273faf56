"""The part of Franka Desk with which programs unlock an arm, for a simulated one."""
