"""A kit with which authors test their own robots, controllers and arms.

It is for tests only: nothing else of the station imports it.
"""
