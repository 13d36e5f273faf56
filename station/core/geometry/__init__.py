"""Solids, capsules and scenes: what is where around the robots, and how far away."""
