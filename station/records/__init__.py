"""Recordings: every cycle kept in MCAP files, read again, recovered and exported."""
