"""The composition root: build a station from its configuration and run it."""
