"""Gain sets and waypoint paths, which operators keep by name on the disk."""
