"""Find the user's stations on this machine, their tokens and certificates."""
