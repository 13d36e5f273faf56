"""Record every cycle in MCAP files; read, recover and export recordings."""
