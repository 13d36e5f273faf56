"""Numbers that the parts of a simulated arm's cycle share."""

NO_MOTION = 0
"""Generator of an arm whose motion commands torques alone, or nothing."""
POSITIONS = 1
"""Generator of joint positions."""
VELOCITIES = 2
"""Generator of joint velocities."""
CARTESIAN = 3
"""Generator of poses or twists of the end effector."""

CONTACT = 1
"""Result of `ArmStep.after`: a contact or a mechanical stop acts on a joint."""
UNUSUAL = 2
"""Result of `ArmStep.after`: the readings must be looked at closer."""
