"""What a URDF says."""
