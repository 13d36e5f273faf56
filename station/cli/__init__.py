"""The command line `station`."""

from station.cli.main import main as main
