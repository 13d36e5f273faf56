"""Closed-loop trials of a simulated station, by the thousand."""
