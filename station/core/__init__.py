"""ros_control itself: the standard library and NumPy, nothing else."""
