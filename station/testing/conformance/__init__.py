"""Suites that test the contracts of robots, controllers and arms."""
