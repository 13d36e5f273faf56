"""Limits of connections, bodies and logins, for both web servers of the station."""
