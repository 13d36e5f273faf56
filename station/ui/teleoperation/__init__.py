"""Move the robot for a person: typed values, sliders and held buttons."""
