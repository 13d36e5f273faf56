"""The recorded behaviour of the original, and its replay."""
