"""What the dashboard knows of the station, and how it keeps that up to date."""
