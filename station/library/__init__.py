"""Gain sets and waypoint paths: what operators keep by name on the disk."""
