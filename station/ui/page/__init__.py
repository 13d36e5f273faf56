"""Requests of the page, and the contents of its docks."""
