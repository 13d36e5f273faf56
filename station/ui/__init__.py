"""The dashboard: a browser client of the station, in a process of its own."""
