"""The watchdog: a small process beside the station that watches its control loop.

It has an interpreter of its own. So a controller that never returns, or that holds the
interpreter lock, cannot keep the watchdog from warning, from accepting a stop, and from
ending the station. Its modules import only the standard library and the heartbeat.
"""
