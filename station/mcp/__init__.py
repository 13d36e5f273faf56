"""Offer the station's operations to agents, as tools of the Model Context Protocol."""
