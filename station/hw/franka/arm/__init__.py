"""The seam: the interface of FrankaHW to an arm, and the facts of every Franka arm."""
