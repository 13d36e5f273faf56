"""The dashboard's knowledge of the station, kept up to date."""
