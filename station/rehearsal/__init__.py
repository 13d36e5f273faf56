"""Rehearsals: forecasts of motions, made in a copy of the station's process."""
