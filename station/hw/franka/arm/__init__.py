"""The seam: what FrankaHW asks of an arm, and what is true of every Franka arm."""
