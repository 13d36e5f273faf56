"""A package, so that what its fixtures start ends before tests of other folders."""
