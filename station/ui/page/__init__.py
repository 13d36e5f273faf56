"""Requests of the page, and what its docks show."""
