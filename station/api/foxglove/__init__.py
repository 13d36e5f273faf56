"""Serve the channels of a recording live to clients of Foxglove's protocol."""
