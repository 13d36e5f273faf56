"""The Franka arm: FrankaHW, the seam to an arm, and the simulated arm behind it."""
