"""Agents' seat: the station's operations as tools of the Model Context Protocol."""
