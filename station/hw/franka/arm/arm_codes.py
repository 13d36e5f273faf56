"""Numbers of an arm's modes, as in libfranka's RobotMode, and of kinds of commands.

They are for compiled code.
"""

IDLE = 1
"""Mode of an arm that holds its pose."""
MOVE = 2
"""Mode of an arm that follows a motion."""
GUIDING = 3
"""Mode of an arm that a person guides."""
RECOVERY = 6
"""Mode of an arm that recovers from an error."""

NO_MOTION = 0
"""Generator of an arm whose motion commands only torques, or nothing."""
POSITIONS = 1
"""Generator of joint positions."""
VELOCITIES = 2
"""Generator of joint velocities."""
CARTESIAN = 3
"""Generator of poses or twists of the end effector."""
