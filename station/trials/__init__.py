"""What a trial is and what came out of it; needs no simulator."""
