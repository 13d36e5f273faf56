"""Gain sets, waypoint paths, plot layouts and scenes that operators keep on disk."""
