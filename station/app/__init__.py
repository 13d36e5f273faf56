"""The composition root: builds a station from its configuration and runs it."""
