"""Numbers for the limits that change a command."""

POSITION = 0
VELOCITY = 1
ACCELERATION = 2
JERK = 3
EFFORT = 4
SOFT_POSITION = 5

NAMES = ("position", "velocity", "acceleration", "jerk", "effort", "soft_position")
"""Names of the limits; the numbers are indices into these."""
