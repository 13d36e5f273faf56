"""Memory and functions that the compiled modules of the control cycle share."""
