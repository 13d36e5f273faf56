"""The watchdog: a small process beside the station that sees whether its loop lives.

It shares no interpreter with the station, so a controller that never returns, or that
holds the interpreter lock, cannot keep it from telling, from taking a stop, and from
ending the station. Its modules import the standard library and the heartbeat only.
"""
