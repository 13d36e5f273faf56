"""Rehearsals: what the station would do, tried in a copy of its process."""
