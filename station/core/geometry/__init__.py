"""Solids, capsules and scenes: objects around the robots, and their distances."""
