"""Trials and their results, without the simulator that runs them."""
