"""Arithmetic: angles, rigid motions, PID, statistics."""
