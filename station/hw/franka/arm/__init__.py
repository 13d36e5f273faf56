"""The seam: the interface of FrankaHW to an arm, and facts about every Franka arm."""
