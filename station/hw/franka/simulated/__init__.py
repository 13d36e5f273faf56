"""A Franka arm simulated in MuJoCo."""
