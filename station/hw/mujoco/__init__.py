"""Any robot that has a URDF, simulated with MuJoCo."""
