"""Suites of tests that hold robots, controllers and arms to their contracts."""
