"""Numbers that the parts of an arm's cycle and those who call them share."""

IDLE = 1
"""Mode of an arm: libfranka's RobotMode, as all modes here."""
MOVE = 2
"""Mode of an arm that follows a motion."""
GUIDING = 3
"""Mode of an arm that a person guides."""
RECOVERY = 6
"""Mode of an arm that recovers from an error."""

NO_MOTION = 0
"""Generator of an arm whose motion commands torques alone, or nothing."""
POSITIONS = 1
"""Generator of joint positions."""
VELOCITIES = 2
"""Generator of joint velocities."""
CARTESIAN = 3
"""Generator of poses or twists of the end effector."""
