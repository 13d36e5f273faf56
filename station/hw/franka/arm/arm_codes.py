"""Numbers of the modes of an arm, those of libfranka's RobotMode, for compiled code."""

IDLE = 1
"""Mode of an arm that holds its pose."""
MOVE = 2
"""Mode of an arm that follows a motion."""
GUIDING = 3
"""Mode of an arm that a person guides."""
RECOVERY = 6
"""Mode of an arm that recovers from an error."""
