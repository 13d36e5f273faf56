"""Trials and their results; needs no simulator."""
