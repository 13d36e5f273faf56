"""A package, whose station ends before the tests of other stations begin."""
