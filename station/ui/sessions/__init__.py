"""Logins, their roles, and their credentials at the station."""
