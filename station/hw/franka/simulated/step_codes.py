"""Numbers of the kinds of motion that a simulated arm follows, for compiled code."""

NO_MOTION = 0
"""Generator of an arm whose motion commands torques alone, or nothing."""
POSITIONS = 1
"""Generator of joint positions."""
VELOCITIES = 2
"""Generator of joint velocities."""
CARTESIAN = 3
"""Generator of poses or twists of the end effector."""
