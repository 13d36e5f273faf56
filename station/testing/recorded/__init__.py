"""Recorded behaviour of ros_control's controller manager, and its replay."""
