"""What the verbs do; each takes the parsed options and returns the exit code."""
